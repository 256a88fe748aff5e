within Effects;
model SensorQuantisation "Steps, by the first harmonic of their error"
  extends Interfaces.Sensor;
  parameter Real k(unit = "1", min = 0, max = 1, nominal = 1) = 0 "Share, 1 for the whole effect";
  parameter Real h(min = 1e-12) = 0.01 "Height of a step, in the unit of the signal";
equation
  y = u + k*h/Modelica.Constants.pi*sin(2*Modelica.Constants.pi*u/h)*(-1);
  annotation(__bramah(family = "sensor_quantisation", id = "E07", coefficients = {"k"}, shapes(h = {0.01, 0.03, 0.1}), relative = {"h"}));
end SensorQuantisation;
