within Mechanical.Rotational.Examples;
model QuadraticLoadExample "Final speed against a quadratic load"
  ConstantTorque drive(tau_constant = 1);
  Inertia mass(J = 1);
  QuadraticLoad load(w_nominal = 1);
equation
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, load.flange);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end QuadraticLoadExample;
