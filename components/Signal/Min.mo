within Signal;
block Min "Smaller of two signals"
  extends Bases.TwoToOne;
equation
  y = min(u1, u2);
  annotation(Documentation(info = "<html><p>The smaller of both inputs.</p></html>"));
end Min;
