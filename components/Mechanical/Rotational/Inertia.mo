within Mechanical.Rotational;
model Inertia "Rigid rotor with inertia"
  Interfaces.RotationalFlange flange_a "Left flange";
  Interfaces.RotationalFlange flange_b "Right flange";
  parameter SI.Inertia J(min = 1e-9, max = 1e9, nominal = 0.01) = 1e-2 "Moment of inertia";
  SI.Angle phi(start = 0, stateSelect = StateSelect.prefer) "Angle";
  SI.AngularVelocity w(nominal = 10, start = 0, stateSelect = StateSelect.prefer) "Angular velocity";
  SI.AngularAcceleration a "Angular acceleration";
equation
  assert(J > 0, "The moment of inertia J must be positive");
  flange_a.phi = phi;
  flange_b.phi = phi;
  w = der(phi);
  a = der(w);
  J*a = flange_a.tau + flange_b.tau;
  annotation(Documentation(info = "<html><p>Both flanges move together. Starts at rest at 0 unless the start values say otherwise; where it is joined rigidly to others, the start that the circuit gives one of them counts for all.</p></html>"));
end Inertia;
