within Effects.Interfaces;
partial model ThermalBridge "Heat between two places"
  input SI.Temperature T_a(stateSelect = StateSelect.avoid, nominal = 300) "Temperature of the first port";
  input SI.Temperature T_b(stateSelect = StateSelect.avoid, nominal = 300) "Temperature of the second port";
  output SI.HeatFlowRate Q_flow(nominal = 100) "Heat from the first to the second port";
  annotation(__bramah(attach = "Bridge", potential = {"T_a", "T_b"}, through = "Q_flow", anywhere = "yes"));
end ThermalBridge;
