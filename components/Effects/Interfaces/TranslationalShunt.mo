within Effects.Interfaces;
partial model TranslationalShunt "Force on one node from the frame"
  input SI.Position s(stateSelect = StateSelect.avoid, nominal = 1e-2) "Position of the node";
  output SI.Force f(nominal = 100) "Force drawn from the node, against its motion";
  SI.Velocity v(nominal = 0.1) "Speed of the node";
equation
  v = der(s);
  annotation(__bramah(attach = "Shunt", potential = {"s"}, through = "f"));
end TranslationalShunt;
