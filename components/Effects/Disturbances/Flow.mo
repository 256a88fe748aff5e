within Effects.Disturbances;
model Flow "Flow that comes from nowhere"
  extends Interfaces.HydraulicShunt;
  parameter Real d(unit = "m3/s", nominal = 1e-6) = 0 "Size";
equation
  q = -d;
  annotation(__bramah(family = "disturbance", coefficients = {"d"}));
end Flow;
