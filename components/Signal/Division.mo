within Signal;
block Division "Quotient u1/u2"
  extends Bases.TwoToOne;
equation
  y = u1/u2;
end Division;
