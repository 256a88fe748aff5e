within Effects;
model InternalLeak "Laminar leakage between two ports"
  extends Interfaces.HydraulicBridge;
  parameter Real G(unit = "m3/(s.Pa)", min = 0, nominal = 3e-12) = 0 "Conductance";
equation
  q = G*dp;
  annotation(__bramah(family = "internal_leak", id = "E19", coefficients = {"G"}, ends = "free"));
end InternalLeak;
