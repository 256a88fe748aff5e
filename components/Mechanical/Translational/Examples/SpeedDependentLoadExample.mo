within Mechanical.Translational.Examples;
model SpeedDependentLoadExample "A load that grows with speed by a table"
  ConstantForce drive(f_constant = 1);
  Mass mass(m = 1);
  SpeedDependentLoad load(table = [-2, -3; -1, -1; 0, 0; 1, 1; 2, 3]);
equation
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, load.flange);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end SpeedDependentLoadExample;
