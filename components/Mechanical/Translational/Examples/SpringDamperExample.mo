within Mechanical.Translational.Examples;
model SpringDamperExample "A damped oscillation"
  Fixed wall;
  SpringDamper spring(c = 100, d = 1);
  Mass mass(m = 1, s(start = 0.1));
equation
  connect(wall.flange, spring.flange_a);
  connect(spring.flange_b, mass.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end SpringDamperExample;
