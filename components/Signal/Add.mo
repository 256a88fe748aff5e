within Signal;
block Add "Weighted sum of two signals"
  extends Bases.TwoToOne;
  parameter Real k1 = 1 "Weight of u1";
  parameter Real k2 = 1 "Weight of u2";
equation
  y = k1*u1 + k2*u2;
end Add;
