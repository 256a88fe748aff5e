within Signal;
block Division "Quotient u1/u2"
  extends Bases.TwoToOne;
equation
  y = u1/u2;
  annotation(Documentation(info = "<html><p><code>y = u_1/u_2</code>; the run stops where u_2 becomes zero.</p></html>"));
end Division;
