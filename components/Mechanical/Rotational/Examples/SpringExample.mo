within Mechanical.Rotational.Examples;
model SpringExample "Two of them joined by a spring"
  Inertia mass(J = 1, phi(start = 0.1));
  Spring spring(c = 100);
  Inertia other(J = 2);
equation
  connect(mass.flange_b, spring.flange_a);
  connect(spring.flange_b, other.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end SpringExample;
