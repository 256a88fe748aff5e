within Mechanical.Rotational.Examples;
model DamperExample "Run down by a damper"
  Fixed wall;
  Damper damper(d = 2);
  Inertia mass(J = 1, w(start = 1));
equation
  connect(wall.flange, damper.flange_a);
  connect(damper.flange_b, mass.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.006, Tolerance = 1e-6));
end DamperExample;
