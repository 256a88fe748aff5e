within Effects;
model LeakToAmbient "Laminar leakage to the surroundings"
  extends Interfaces.HydraulicShunt;
  parameter Real G(unit = "m3/(s.Pa)", min = 0, nominal = 3e-12) = 0 "Conductance";
  parameter SI.Pressure p_0 = 1e5 "Pressure of the surroundings";
equation
  q = G*(p - p_0);
  annotation(__bramah(family = "external_leak", id = "E38", coefficients = {"G"}, surroundings = "p_0", without = "Drain"));
end LeakToAmbient;
