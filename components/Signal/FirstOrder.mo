within Signal;
block FirstOrder "Lag of first order: k/(T s + 1)"
  extends Bases.OneToOne;
  parameter Real k = 1 "Gain";
  parameter SI.Time T(min = 1e-9) = 1 "Time constant";
  parameter Real y_start = 0 "Output at the start";
initial equation
  y = y_start;
equation
  assert(T > 0, "The time constant T must be positive");
  T*der(y) = k*u - y;
  annotation(Documentation(info = "<html><p><code>T dy/dt + y = k u</code>.</p></html>"));
end FirstOrder;
