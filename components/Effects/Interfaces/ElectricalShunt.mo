within Effects.Interfaces;
partial model ElectricalShunt "Draws a current from one node"
  input SI.ElectricPotential v(stateSelect = StateSelect.avoid) "Potential of the node";
  output SI.Current i "Current drawn from the node";
  annotation(__bramah(attach = "Shunt", potential = {"v"}, through = "i"));
end ElectricalShunt;
