within Effects.Interfaces;
partial model RotationalBridge "Torque between two flanges of a component"
  input SI.Angle phi_a(stateSelect = StateSelect.avoid) "Angle of the first flange";
  input SI.Angle phi_b(stateSelect = StateSelect.avoid) "Angle of the second flange";
  output SI.Torque tau "Torque from the first to the second flange";
  SI.Angle phi_rel "Angle of the first flange relative to the second";
  SI.AngularVelocity w_rel(nominal = 10) "Speed of the first flange relative to the second";
equation
  phi_rel = phi_a - phi_b;
  w_rel = der(phi_a) - der(phi_b);
  annotation(__bramah(attach = "Bridge", potential = {"phi_a", "phi_b"}, through = "tau"));
end RotationalBridge;
