within Smooth;
function ramp "Positive part of u with a parabola from 0 to w: 0, u^2/(2 w), u - w/2"
  input Real u "Argument";
  input Real w(min = 0) = 0.1 "Length of the parabola, in the unit of u";
  output Real y "Never negative, continuous first derivative, exactly 0 for u <= 0";
protected
  Real v;
algorithm
  v := min(max(u, 0), w);
  y := v*v/(2*w) + max(u - w, 0);
  annotation(Inline = true, Documentation(info = "<html><p>The positive part, shifted by <code>w/2</code> beyond the parabola; exactly zero below, unlike <code>pos</code>.</p></html>"));
end ramp;
