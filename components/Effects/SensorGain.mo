within Effects;
model SensorGain "The sensor shows a wrong scale"
  extends Interfaces.Sensor;
  parameter Real k(unit = "1", nominal = 0.03) = 0 "Relative error of the scale";
equation
  y = u + k*u;
  annotation(__bramah(family = "sensor_gain", id = "E39", coefficients = {"k"}));
end SensorGain;
