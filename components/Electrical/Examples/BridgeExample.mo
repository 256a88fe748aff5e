within Electrical.Examples;
model BridgeExample "A DC motor on a bridge"
  ConstantVoltage source(V = 24);
  Bridge bridge;
  Machines.DCMotor motor(R = 0.5, L = 1e-3, k = 0.05);
  Mechanical.Rotational.Inertia rotor(J = 1e-4);
  Mechanical.Rotational.Damper friction(d = 1e-4);
  Mechanical.Rotational.Fixed housing;
  Signal.TimeTable command(table = [0, 0; 0.1, 1; 0.5, 1; 0.6, -1; 1, -1]);
  Ground ground;
equation
  connect(source.p, bridge.dc_p);
  connect(source.n, bridge.dc_n);
  connect(source.n, ground.p);
  connect(bridge.p, motor.p);
  connect(bridge.n, motor.n);
  connect(bridge.n, ground.p);
  connect(motor.flange, rotor.flange_a);
  connect(rotor.flange_b, friction.flange_a);
  connect(friction.flange_b, housing.flange);
  connect(command.y, bridge.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end BridgeExample;
