within Mechanical.Translational.Examples;
model ElastoBacklashExample "Reversal through backlash"
  Signal.Sine sine(amplitude = 10, f = 1);
  Force drive;
  Mass mass(m = 1);
  ElastoBacklash play(b = 0.02, c = 1e3, d = 5);
  Mass load(m = 1);
equation
  connect(sine.y, drive.f);
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, play.flange_a);
  connect(play.flange_b, load.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.006, Tolerance = 1e-6));
end ElastoBacklashExample;
