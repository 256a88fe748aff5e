within Effects.Interfaces;
partial model TranslationalBridge "Force between two flanges of a component"
  input SI.Position s_a(stateSelect = StateSelect.avoid, nominal = 1e-2) "Position of the first flange";
  input SI.Position s_b(stateSelect = StateSelect.avoid, nominal = 1e-2) "Position of the second flange";
  output SI.Force f(nominal = 100) "Force from the first to the second flange";
  SI.Position s_rel(nominal = 1e-2) "Position of the first flange relative to the second";
  SI.Velocity v_rel(nominal = 0.1) "Speed of the first flange relative to the second";
equation
  s_rel = s_a - s_b;
  v_rel = der(s_a) - der(s_b);
  annotation(__bramah(attach = "Bridge", potential = {"s_a", "s_b"}, through = "f"));
end TranslationalBridge;
