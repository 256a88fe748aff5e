within Mechanical.Rotational;
model RelativePositionSensor "Angle of one flange relative to another"
  Interfaces.RotationalFlange flange_a "First flange";
  Interfaces.RotationalFlange flange_b "Second flange";
  Interfaces.RealOutput phi_rel(unit = "rad") "Angle of b relative to a";
equation
  phi_rel = flange_b.phi - flange_a.phi;
  flange_a.tau = 0;
  flange_b.tau = 0;
  annotation(Documentation(info = "<html><p><code>phi_rel = phi_b - phi_a</code>, without torque.</p></html>"));
end RelativePositionSensor;
