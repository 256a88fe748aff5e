within Effects.Interfaces;
partial model HydraulicDrainAtRod "Volume flow beside a rod of the network, from a node to a node of constant pressure"
  input SI.Pressure p(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the node";
  input SI.Pressure p_0(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the low side";
  input SI.Position s(stateSelect = StateSelect.avoid, nominal = 1e-2) "Position of the rod";
  output SI.VolumeFlowRate q(nominal = 1e-4) "Flow from the node to the low side";
  annotation(__bramah(attach = "Drain", potential = {"p", "p_0"}, through = "q", sense = {"s"}, anywhere = "yes"));
end HydraulicDrainAtRod;
