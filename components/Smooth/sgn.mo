within Smooth;
function sgn "Sign of x, rounded over the width w: tanh(x/w)"
  input Real x "Argument";
  input Real w(min = 0) "Width, in the unit of x";
  output Real y "Between -1 and 1";
algorithm
  y := tanh(x/w);
  annotation(Inline = true, Documentation(info = "<html><p>Reaches 96 % of the sign at <code>2 w</code>. Odd, so that a product with x is never negative.</p></html>"));
end sgn;
