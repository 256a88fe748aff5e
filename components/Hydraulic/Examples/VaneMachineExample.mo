within Hydraulic.Examples;
model VaneMachineExample "A pump builds pressure against an orifice, forwards and backwards"
  inner Oil.ISOVG46 oil "Oil";
  Signal.TimeTable speed(table = [0, 0; 0.2, 150; 0.5, 150; 0.9, -150; 1.2, -150]);
  Mechanical.Rotational.Speed drive;
  VaneMachine pump(V = 2e-5);
  Tank tank(p = 3e5);
  Volume side_A(V = 2e-4, p_start = 3e5);
  Volume side_B(V = 2e-4, p_start = 3e5);
  Orifice load(A = 4e-6);
  CheckValve check_A "From the tank to A";
  CheckValve check_B "From the tank to B";
equation
  connect(speed.y, drive.w_ref);
  connect(drive.flange, pump.flange);
  connect(pump.port_a, side_A.port);
  connect(pump.port_b, side_B.port);
  connect(side_A.port, load.port_a);
  connect(load.port_b, side_B.port);
  connect(tank.port, check_A.port_a);
  connect(check_A.port_b, side_A.port);
  connect(tank.port, check_B.port_a);
  connect(check_B.port_b, side_B.port);
  annotation(experiment(StartTime = 0, StopTime = 1.2, Interval = 0.002, Tolerance = 1e-6));
end VaneMachineExample;
