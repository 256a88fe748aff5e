within Effects;
model GasLeak "Gas that leaks past a component through a narrow gap"
  extends Interfaces.GasBridge;
  parameter Real G(unit = "kg/(s.Pa)", min = 0, nominal = 1e-10) = 0 "Mass flow per pressure difference";
equation
  m_flow = G*dp;
  annotation(__bramah(family = "internal_leak", id = "E19", coefficients = {"G"}));
end GasLeak;
