within Smooth;
function mag "Magnitude of x, zero with zero slope at 0: sqrt(x^2 + w^2) - w"
  input Real x "Argument";
  input Real w(min = 0) "Width, in the unit of x";
  output Real y "Never negative, |x| - w far from 0";
algorithm
  y := sqrt(x*x + w*w) - w;
  annotation(Inline = true, Documentation(info = "<html><p>Zero at x = 0, so that a product with an odd function stays passive.</p></html>"));
end mag;
