within Mechanical.Rotational.Examples;
model ScrewExample "A spindle lifts a load and lets it down"
  Signal.Sine sine(amplitude = 2, f = 1, offset = 1.6);
  Torque drive;
  Inertia mass(J = 1e-3);
  Screw screw(eta = 0.8);
  Mechanical.Translational.Mass load(m = 100);
  Mechanical.Translational.Gravity weight(m = 100);
equation
  connect(sine.y, drive.tau);
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, screw.flangeR);
  connect(screw.flangeT, load.flange_a);
  connect(load.flange_b, weight.flange);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end ScrewExample;
