within Smooth;
function clip "Opening that rises from 0 at u = 0 to 1 at u = 1, corners rounded by parabolas"
  input Real u "Argument";
  input Real w(min = 0, max = 0.5) = 0.1 "Length of the rounded corners";
  output Real y "Between 0 and 1, continuous first derivative, exactly 0 for u <= 0 and 1 for u >= 1";
algorithm
  y := (Smooth.ramp(u, w) - Smooth.ramp(u - 1 + w, w))/(1 - w);
  annotation(Inline = true, Documentation(info = "<html><p><code>(ramp(u, w) - ramp(u - 1 + w, w))/(1 - w)</code>: both corners lie between 0 and 1, so that the opening is full at <code>u = 1</code>, where the page of a valve says; the slope between them is <code>1/(1 - w)</code>, and <code>y(1 - u) = 1 - y(u)</code>. The opening of a valve over its command or over pressure.</p></html>"));
end clip;
