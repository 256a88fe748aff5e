within Signal;
block Min "Smaller of two signals"
  extends Bases.TwoToOne;
equation
  y = min(u1, u2);
end Min;
