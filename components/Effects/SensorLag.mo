within Effects;
model SensorLag "First order lag"
  extends Interfaces.Sensor;
  parameter Real k(unit = "1", min = 0, max = 1, nominal = 1) = 0 "Share, 1 for the whole effect";
  parameter SI.Time T_l(min = 1e-9) = 5e-3 "Time constant";
  Real x "Value that lags";
initial equation
  x = u;
equation
  T_l*der(x) = u - x;
  y = u - k*(u - x);
  annotation(__bramah(family = "sensor_lag", id = "E39", coefficients = {"k"}, shapes(T_l = {2e-3, 6e-3, 2e-2, 6e-2})));
end SensorLag;
