within Mechanical.Rotational.Examples;
model InertiaExample "Driven by an alternating torque"
  Signal.Sine sine(amplitude = 10, f = 1);
  Torque drive;
  Inertia mass(J = 1);
equation
  connect(sine.y, drive.tau);
  connect(drive.flange, mass.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.006, Tolerance = 1e-6));
end InertiaExample;
