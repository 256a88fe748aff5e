within Mechanical.Rotational.Examples;
model LuGreBearingFrictionExample "Dry friction against the housing under an alternating load"
  Signal.Sine sine(amplitude = 10, f = 1);
  Torque drive;
  Inertia mass(J = 1);
  LuGreBearingFriction friction(tau_c = 3, tau_s = 4, w_s = 0.1);
equation
  connect(sine.y, drive.tau);
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, friction.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end LuGreBearingFrictionExample;
