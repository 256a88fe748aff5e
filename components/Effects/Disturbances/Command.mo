within Effects.Disturbances;
model Command "Command that nobody gave"
  extends Interfaces.Command;
  parameter Real d(nominal = 1e-3) = 0 "Size";
equation
  y = u + d;
  annotation(__bramah(family = "disturbance", coefficients = {"d"}));
end Command;
