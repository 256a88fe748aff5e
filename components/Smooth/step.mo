within Smooth;
function step "Smooth step from 0 at u <= 0 to 1 at u >= 1: 3 u^2 - 2 u^3"
  input Real u "Argument";
  output Real y "Between 0 and 1, continuous first derivative";
protected
  Real v;
algorithm
  v := min(max(u, 0), 1);
  y := v*v*(3 - 2*v);
  annotation(Inline = true, Documentation(info = "<html><p>The Hermite polynomial: value and slope are continuous, the curvature jumps at both ends.</p></html>"));
end step;
