within Signal;
block Feedback "Difference u1 - u2"
  extends Bases.TwoToOne;
equation
  y = u1 - u2;
  annotation(Documentation(info = "<html><p><code>y = u_1 - u_2</code>.</p></html>"));
end Feedback;
