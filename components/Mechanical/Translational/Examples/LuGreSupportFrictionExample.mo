within Mechanical.Translational.Examples;
model LuGreSupportFrictionExample "Dry friction against the housing under an alternating load"
  Signal.Sine sine(amplitude = 10, f = 1);
  Force drive;
  Mass mass(m = 1);
  LuGreSupportFriction friction(f_c = 3, f_s = 4, v_s = 0.1);
equation
  connect(sine.y, drive.f);
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, friction.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end LuGreSupportFrictionExample;
