within Effects;
model ShaftCompliance "Elastic connection"
  extends Interfaces.RotationalSeries;
  parameter Real c(unit = "rad/(N.m)", min = 0, nominal = 1e-4) = 0 "Compliance";
equation
  phi_rel = c*tau;
  annotation(__bramah(family = "shaft_compliance", id = "E37", coefficients = {"c"}));
end ShaftCompliance;
