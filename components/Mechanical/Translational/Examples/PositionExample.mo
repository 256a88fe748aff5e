within Mechanical.Translational.Examples;
model PositionExample "A flange led along a sine"
  Signal.Sine sine(amplitude = 0.1, f = 1);
  Position guide;
  SpringDamper spring(c = 100, d = 1);
  Mass mass(m = 1);
equation
  connect(sine.y, guide.s_ref);
  connect(guide.flange, spring.flange_a);
  connect(spring.flange_b, mass.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end PositionExample;
