within Effects;
model SensorDrift "The zero moves in time"
  extends Interfaces.Sensor;
  parameter Real r(nominal = 0.005) = 0 "Drift, in units of the signal a second";
equation
  y = u + r*time;
  annotation(__bramah(family = "sensor_drift", id = "E39", coefficients = {"r"}, relative = {"r"}));
end SensorDrift;
