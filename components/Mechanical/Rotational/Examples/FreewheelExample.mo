within Mechanical.Rotational.Examples;
model FreewheelExample "An oscillating drive turns a flywheel one way"
  Signal.Sine sine(amplitude = 20, f = 1);
  Torque drive;
  Inertia crank(J = 1);
  Freewheel freewheel(tau_drag = 0.1);
  Inertia flywheel(J = 2);
  Damper bearing(d = 0.2);
  Fixed housing;
equation
  connect(sine.y, drive.tau);
  connect(drive.flange, crank.flange_a);
  connect(crank.flange_b, freewheel.flange_a);
  connect(freewheel.flange_b, flywheel.flange_a);
  connect(flywheel.flange_b, bearing.flange_a);
  connect(bearing.flange_b, housing.flange);
  annotation(experiment(StartTime = 0, StopTime = 10, Interval = 0.02, Tolerance = 1e-6));
end FreewheelExample;
