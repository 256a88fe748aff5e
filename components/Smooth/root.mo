within Smooth;
function root "Signed square root of x with a finite slope at 0: x/(x^2 + t^2)^(1/4)"
  input Real x "Argument";
  input Real t(min = 0) "Transition, in the unit of x: slope 1/sqrt(t) at 0";
  output Real y "sqrt(x) for x >> t";
algorithm
  y := x/(x*x + t*t)^0.25;
  annotation(Inline = true, Documentation(info = "<html><p>Far from 0 the signed square root, at 0 a straight line of slope <code>1/sqrt(t)</code>: the flow of an orifice with its laminar transition. Odd, passive in a product with x.</p></html>"));
end root;
