within Mechanical.Rotational.Examples;
model ConstantTorqueExample "Constant acceleration"
  ConstantTorque drive(tau_constant = 1);
  Inertia mass(J = 1);
equation
  connect(drive.flange, mass.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end ConstantTorqueExample;
