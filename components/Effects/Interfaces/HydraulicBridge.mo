within Effects.Interfaces;
partial model HydraulicBridge "Volume flow between two ports of a component"
  input SI.Pressure p_a(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the first port";
  input SI.Pressure p_b(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the second port";
  output SI.VolumeFlowRate q(nominal = 1e-4) "Flow from the first to the second port";
  SI.Pressure dp(nominal = 1e6) "Pressure difference";
equation
  dp = p_a - p_b;
  annotation(__bramah(attach = "Bridge", potential = {"p_a", "p_b"}, through = "q"));
end HydraulicBridge;
