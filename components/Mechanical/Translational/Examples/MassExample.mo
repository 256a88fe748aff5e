within Mechanical.Translational.Examples;
model MassExample "Driven by an alternating force"
  Signal.Sine sine(amplitude = 10, f = 1);
  Force drive;
  Mass mass(m = 1);
equation
  connect(sine.y, drive.f);
  connect(drive.flange, mass.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.006, Tolerance = 1e-6));
end MassExample;
