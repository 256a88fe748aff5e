within Effects.Interfaces;
partial model GasBridge "Mass flow of gas between two ports of a component"
  input SI.AbsolutePressure p_a(stateSelect = StateSelect.avoid, nominal = 1e5) "Pressure of the first port";
  input SI.AbsolutePressure p_b(stateSelect = StateSelect.avoid, nominal = 1e5) "Pressure of the second port";
  output SI.MassFlowRate m_flow(nominal = 1e-3) "Mass flow from the first to the second port";
  SI.Pressure dp(nominal = 1e5) "Pressure difference";
equation
  dp = p_a - p_b;
  annotation(__bramah(attach = "Bridge", potential = {"p_a", "p_b"}, through = "m_flow"));
end GasBridge;
