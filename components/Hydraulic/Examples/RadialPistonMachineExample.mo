within Hydraulic.Examples;
model RadialPistonMachineExample "A slow motor turns a load one way and the other"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 150e5);
  Tank tank(p = 3e5);
  Valve43 valve(q_nom = 4e-4);
  Volume side_A(V = 2e-4, p_start = 76e5);
  Volume side_B(V = 2e-4, p_start = 76e5);
  RadialPistonMachine motor;
  Mechanical.Rotational.Inertia load(J = 2);
  Mechanical.Rotational.Damper brake(d = 10);
  Mechanical.Rotational.Fixed housing;
  Signal.TimeTable command(table = [0, 0; 0.1, 0; 0.3, 0.7; 1.2, 0.7; 1.6, -0.7; 2.5, -0.7; 2.7, 0; 3, 0]);
equation
  connect(source.port, valve.port_P);
  connect(valve.port_T, tank.port);
  connect(valve.port_A, side_A.port);
  connect(valve.port_B, side_B.port);
  connect(side_A.port, motor.port_b);
  connect(side_B.port, motor.port_a);
  connect(motor.flange, load.flange_a);
  connect(load.flange_b, brake.flange_a);
  connect(brake.flange_b, housing.flange);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.005, Tolerance = 1e-6));
end RadialPistonMachineExample;
