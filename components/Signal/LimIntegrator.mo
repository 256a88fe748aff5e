within Signal;
block LimIntegrator "Integrator that stops at limits"
  extends Bases.OneToOne;
  parameter Real k = 1 "Gain";
  parameter Real yMax = 1 "Upper limit";
  parameter Real yMin = -yMax "Lower limit";
  parameter Real y_start = 0 "Output at the start";
initial equation
  y = y_start;
equation
  assert(yMax > yMin, "yMax must lie above yMin");
  der(y) = if y < yMin and k*u < 0 or y > yMax and k*u > 0 then 0 else k*u;
  annotation(Documentation(info = "<html><p><code>dy/dt = k u</code> while y lies within its limits; at a limit it waits until u turns.</p></html>"));
end LimIntegrator;
