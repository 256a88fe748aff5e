within Signal;
block Gain "Product with a constant"
  extends Bases.OneToOne;
  parameter Real k = 1 "Gain";
equation
  y = k*u;
  annotation(Documentation(info = "<html><p><code>y = k u</code>.</p></html>"));
end Gain;
