within Effects.Disturbances;
model Force "Force that comes from nowhere"
  extends Interfaces.TranslationalShunt;
  parameter Real d(unit = "N", nominal = 10) = 0 "Size";
equation
  f = -d;
  annotation(__bramah(family = "disturbance", coefficients = {"d"}));
end Force;
