within Effects;
model RodCompliance "Elastic connection"
  extends Interfaces.TranslationalSeries;
  parameter Real c(unit = "m/N", min = 0, nominal = 1e-7) = 0 "Compliance";
equation
  s_rel = c*f;
  annotation(__bramah(family = "shaft_compliance", id = "E37", coefficients = {"c"}));
end RodCompliance;
