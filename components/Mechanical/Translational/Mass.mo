within Mechanical.Translational;
model Mass "Rigid mass sliding along one axis"
  Interfaces.TranslationalFlange flange_a "Left flange";
  Interfaces.TranslationalFlange flange_b "Right flange";
  parameter SI.Mass m(min = 1e-5, max = 1e9, nominal = 1) = 1 "Mass";
  SI.Position s(nominal = 1e-2, start = 0, stateSelect = StateSelect.prefer) "Position";
  SI.Velocity v(nominal = 0.1, start = 0, stateSelect = StateSelect.prefer) "Velocity";
  SI.Acceleration a "Acceleration";
equation
  assert(m > 0, "The mass m must be positive");
  flange_a.s = s;
  flange_b.s = s;
  v = der(s);
  a = der(v);
  m*a = flange_a.f + flange_b.f;
  annotation(Documentation(info = "<html><p>Both flanges move together. Starts at rest at 0 unless the start values say otherwise; where it is joined rigidly to others, the start that the circuit gives one of them counts for all.</p></html>"));
end Mass;
