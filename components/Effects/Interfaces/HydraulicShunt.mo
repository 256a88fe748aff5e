within Effects.Interfaces;
partial model HydraulicShunt "Draws a volume flow from one node"
  input SI.Pressure p(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the node";
  output SI.VolumeFlowRate q(nominal = 1e-4) "Flow drawn from the node";
  annotation(__bramah(attach = "Shunt", potential = {"p"}, through = "q"));
end HydraulicShunt;
