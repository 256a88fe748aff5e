within Effects.Interfaces;
partial model TranslationalShuntAtChamber "Force on the flange of a component with a hydraulic port"
  input SI.Position s(stateSelect = StateSelect.avoid, nominal = 1e-2) "Position of the node";
  input SI.Pressure p(stateSelect = StateSelect.avoid, nominal = 1e6) "Pressure of the port";
  output SI.Force f(nominal = 100) "Force drawn from the node, against its motion";
  SI.Velocity v(nominal = 0.1) "Speed of the node";
equation
  v = der(s);
  annotation(__bramah(attach = "Shunt", potential = {"s"}, through = "f", sense = {"p"}));
end TranslationalShuntAtChamber;
