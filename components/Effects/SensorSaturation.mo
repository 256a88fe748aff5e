within Effects;
model SensorSaturation "Clipped beyond a limit"
  extends Interfaces.Sensor;
  parameter Real k(unit = "1", min = 0, max = 1, nominal = 1) = 0 "Share, 1 for the whole effect";
  parameter Real m(min = 0) = 0.7 "Limit, in the unit of the signal";
  parameter Real w(unit = "1", min = 1e-9) = 0.02 "Width of the corner over the limit";
equation
  y = u - k*(Smooth.pos(u - m, w*m) - Smooth.pos(-u - m, w*m));
  annotation(__bramah(family = "sensor_saturation", id = "E11", coefficients = {"k"}, shapes(m = {0.4, 0.6, 0.8, 0.95}), relative = {"m"}, limit = {"m"}));
end SensorSaturation;
