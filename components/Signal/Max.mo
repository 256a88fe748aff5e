within Signal;
block Max "Greater of two signals"
  extends Bases.TwoToOne;
equation
  y = max(u1, u2);
  annotation(Documentation(info = "<html><p>The greater of both inputs.</p></html>"));
end Max;
