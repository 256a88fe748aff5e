within Mechanical.Rotational.Examples;
model LoadMachineExample "A motor against a load machine"
  ConstantTorque drive(tau_constant = 20);
  Inertia rotor(J = 0.2);
  Signal.Step command(height = 15, offset = 5, startTime = 1);
  LoadMachine load(c_00 = 2, c_01 = 0.05);
equation
  connect(drive.flange, rotor.flange_a);
  connect(rotor.flange_b, load.flange);
  connect(command.y, load.u);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.006, Tolerance = 1e-6));
end LoadMachineExample;
