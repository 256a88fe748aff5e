within Effects;
model SensorOffset "A constant is added"
  extends Interfaces.Sensor;
  parameter Real b(nominal = 0.02) = 0 "Offset, in the unit of the signal";
equation
  y = u + b;
  annotation(__bramah(family = "sensor_offset", id = "E39", coefficients = {"b"}, relative = {"b"}));
end SensorOffset;
