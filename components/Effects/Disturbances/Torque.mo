within Effects.Disturbances;
model Torque "Torque that comes from nowhere"
  extends Interfaces.RotationalShunt;
  parameter Real d(unit = "N.m", nominal = 0.1) = 0 "Size";
equation
  tau = -d;
  annotation(__bramah(family = "disturbance", coefficients = {"d"}));
end Torque;
