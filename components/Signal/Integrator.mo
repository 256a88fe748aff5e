within Signal;
block Integrator "Integrator"
  extends Bases.OneToOne;
  parameter Real k = 1 "Gain";
  parameter Real y_start = 0 "Output at the start";
initial equation
  y = y_start;
equation
  der(y) = k*u;
  annotation(Documentation(info = "<html><p><code>dy/dt = k u</code>.</p></html>"));
end Integrator;
