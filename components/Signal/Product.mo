within Signal;
block Product "Product of two signals"
  extends Bases.TwoToOne;
equation
  y = u1*u2;
end Product;
