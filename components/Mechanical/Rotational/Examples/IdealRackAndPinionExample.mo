within Mechanical.Rotational.Examples;
model IdealRackAndPinionExample "A motor moves a carriage"
  ConstantTorque drive(tau_constant = 1);
  Inertia mass(J = 1e-3);
  IdealRackAndPinion rack(ratio = 100);
  Mechanical.Translational.Mass carriage(m = 10);
equation
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, rack.flangeR);
  connect(rack.flangeT, carriage.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end IdealRackAndPinionExample;
