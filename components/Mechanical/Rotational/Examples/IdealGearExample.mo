within Mechanical.Rotational.Examples;
model IdealGearExample "A load behind a gear"
  Signal.Sine sine(amplitude = 1, f = 1);
  Torque drive;
  Inertia mass(J = 0.1);
  IdealGear gear(ratio = 3);
  Inertia load(J = 1);
  Fixed housing;
  Damper friction(d = 0.5);
equation
  connect(sine.y, drive.tau);
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, gear.flange_a);
  connect(gear.flange_b, load.flange_a);
  connect(load.flange_b, friction.flange_a);
  connect(friction.flange_b, housing.flange);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.006, Tolerance = 1e-6));
end IdealGearExample;
