within Smooth;
function blend "One value where x is positive, another where it is negative, rounded over the width w"
  input Real x "What decides";
  input Real w(min = 0) "Width, in the unit of x";
  input Real positive "Value where x is positive";
  input Real negative "Value where x is negative";
  output Real y "Between the two";
algorithm
  y := (positive + negative)/2 + Smooth.sgn(x, w)*(positive - negative)/2;
  annotation(Inline = true, Documentation(info = "<html><p>What a flow carries is that of the side from which it comes; at rest it is the mean of both sides.</p></html>"));
end blend;
