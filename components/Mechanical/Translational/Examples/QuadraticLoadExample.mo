within Mechanical.Translational.Examples;
model QuadraticLoadExample "Final speed against a quadratic load"
  ConstantForce drive(f_constant = 1);
  Mass mass(m = 1);
  QuadraticLoad load(v_nominal = 1);
equation
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, load.flange);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end QuadraticLoadExample;
