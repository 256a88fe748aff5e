within Mechanical.Translational.Examples;
model GravityExample "A weight on a spring"
  Fixed ceiling;
  Spring spring(c = 100);
  Mass mass(m = 1);
  Gravity weight(m = 1);
equation
  connect(ceiling.flange, spring.flange_a);
  connect(spring.flange_b, mass.flange_a);
  connect(mass.flange_b, weight.flange);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.006, Tolerance = 1e-6));
end GravityExample;
