within Effects;
model ExternalLeak "Laminar leakage to the low side"
  extends Interfaces.HydraulicDrain;
  parameter Real G(unit = "m3/(s.Pa)", min = 0, nominal = 3e-12) = 0 "Conductance";
equation
  q = G*(p - p_0);
  annotation(__bramah(family = "external_leak", id = "E38", coefficients = {"G"}));
end ExternalLeak;
