within Effects.Interfaces;
partial model ThermalShunt "Draws heat from one node"
  input SI.Temperature T(stateSelect = StateSelect.avoid, nominal = 300) "Temperature of the node";
  output SI.HeatFlowRate Q_flow(nominal = 100) "Heat drawn from the node";
  annotation(__bramah(attach = "Shunt", potential = {"T"}, through = "Q_flow"));
end ThermalShunt;
