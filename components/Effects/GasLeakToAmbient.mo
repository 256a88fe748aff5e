within Effects;
model GasLeakToAmbient "Gas that leaks to the surroundings through a narrow gap"
  extends Interfaces.GasShunt;
  parameter Real G(unit = "kg/(s.Pa)", min = 0, nominal = 1e-10) = 0 "Mass flow per pressure difference";
  parameter SI.AbsolutePressure p_0 = 101325 "Pressure of the surroundings";
equation
  m_flow = G*(p - p_0);
  annotation(__bramah(family = "external_leak", id = "E38", coefficients = {"G"}, surroundings = "p_0"));
end GasLeakToAmbient;
