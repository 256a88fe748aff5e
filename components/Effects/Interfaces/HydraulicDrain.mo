within Effects.Interfaces;
partial model HydraulicDrain "Volume flow from a node to a node of constant pressure"
  input SI.Pressure p(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the node";
  input SI.Pressure p_0(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the low side";
  output SI.VolumeFlowRate q(nominal = 1e-4) "Flow from the node to the low side";
  annotation(__bramah(attach = "Drain", potential = {"p", "p_0"}, through = "q"));
end HydraulicDrain;
