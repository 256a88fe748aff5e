within Effects;
model SensorRectification "The sensor shows the magnitude"
  extends Interfaces.Sensor;
  parameter Real k(unit = "1", min = 0, max = 1, nominal = 1) = 0 "Share, 1 for the whole effect";
  parameter Real w(min = 1e-12) = 0.01 "Width of the corner, in the unit of the signal";
equation
  y = u + k*(sqrt(u*u + w*w) - u);
  annotation(__bramah(family = "sensor_rectification", id = "E39", coefficients = {"k"}, shapes(w = {0.01}), relative = {"w"}));
end SensorRectification;
