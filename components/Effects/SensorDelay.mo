within Effects;
model SensorDelay "What is recorded comes late: approximant of fifth order in place of the delay"
  extends Interfaces.Sensor;
  parameter Real k(unit = "1", min = 0, max = 1, nominal = 1) = 0 "Share, 1 for the whole effect";
  parameter SI.Time T_d(min = 1e-6) = 3e-3 "Delay";
  Real x "Filtered value";
  Real z "Change of it during the delay";
  Real b "Change of that during the delay";
initial equation
  x = u;
  z = 0;
  b = 0;
equation
  T_d*der(x) = z;
  T_d*der(z) = b;
  T_d*der(b) = 60*(u - x) - 36*z - 9*b;
  y = u + k*(x - 2/5*z + b/20 - u);
  annotation(__bramah(family = "sensor_delay", id = "E39", coefficients = {"k"}, shapes(T_d = {1e-3, 2e-3, 5e-3, 1e-2, 3e-2})));
end SensorDelay;
