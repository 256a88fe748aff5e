within Signal;
block Max "Greater of two signals"
  extends Bases.TwoToOne;
equation
  y = max(u1, u2);
end Max;
