within Mechanical.Translational.Examples;
model PositionDependentLoadExample "A load that grows on the way by a table"
  ConstantForce drive(f_constant = 1);
  Mass mass(m = 1);
  PositionDependentLoad load(table = [0, 0; 1, 0; 2, 5]);
equation
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, load.flange);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end PositionDependentLoadExample;
