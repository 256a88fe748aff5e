within Effects.Interfaces;
partial model HydraulicBridgeAtRod "Volume flow between two ports of a component, and the position of a rod of the network"
  input SI.Pressure p_a(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the first port";
  input SI.Pressure p_b(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the second port";
  input SI.Position s(stateSelect = StateSelect.avoid, nominal = 1e-2) "Position of the rod";
  output SI.VolumeFlowRate q(nominal = 1e-4) "Flow from the first to the second port";
  SI.Pressure dp(nominal = 1e6) "Pressure difference";
equation
  dp = p_a - p_b;
  annotation(__bramah(attach = "Bridge", potential = {"p_a", "p_b"}, through = "q", sense = {"s"}, anywhere = "yes"));
end HydraulicBridgeAtRod;
