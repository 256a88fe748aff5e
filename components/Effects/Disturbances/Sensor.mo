within Effects.Disturbances;
model Sensor "Reading that nothing caused"
  extends Interfaces.Sensor;
  parameter Real d(nominal = 1e-3) = 0 "Size";
equation
  y = u + d;
  annotation(__bramah(family = "disturbance", coefficients = {"d"}));
end Sensor;
