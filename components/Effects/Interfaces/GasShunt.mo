within Effects.Interfaces;
partial model GasShunt "Draws a mass flow of gas from one node"
  input SI.AbsolutePressure p(stateSelect = StateSelect.avoid, nominal = 1e5) "Pressure of the node";
  output SI.MassFlowRate m_flow(nominal = 1e-3) "Mass flow drawn from the node";
  annotation(__bramah(attach = "Shunt", potential = {"p"}, through = "m_flow"));
end GasShunt;
