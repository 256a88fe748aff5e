within Mechanical.Translational.Examples;
model ConstantForceExample "Constant acceleration"
  ConstantForce drive(f_constant = 1);
  Mass mass(m = 1);
equation
  connect(drive.flange, mass.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end ConstantForceExample;
