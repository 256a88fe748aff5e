within Effects.Interfaces;
partial model ElectricalBridge "Current between two pins of a component"
  input SI.ElectricPotential v_a(stateSelect = StateSelect.avoid) "Potential of the first pin";
  input SI.ElectricPotential v_b(stateSelect = StateSelect.avoid) "Potential of the second pin";
  output SI.Current i "Current from the first to the second pin";
  SI.Voltage v "Voltage";
equation
  v = v_a - v_b;
  annotation(__bramah(attach = "Bridge", potential = {"v_a", "v_b"}, through = "i"));
end ElectricalBridge;
