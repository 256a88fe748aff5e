within Hydraulic.Examples;
model CartridgeValveExample "A pump is unloaded and loaded by a way valve in the pilot line"
  inner Oil.ISOVG46 oil "Oil";
  FlowSource pump(q = 2e-3);
  Volume line(V = 2e-3, p_start = 10e5);
  ReliefValve relief(p_set = 150e5, q_nom = 2e-3);
  CartridgeValve valve;
  Valve32 pilot(A_max = 5e-6);
  Signal.Pulse load(width = 0.5, period = 0.5, startTime = 0.2);
  Tank tank;
equation
  connect(pump.port, line.port);
  connect(line.port, relief.port_a);
  connect(relief.port_b, tank.port);
  connect(line.port, valve.port_a);
  connect(valve.port_b, tank.port);
  connect(line.port, pilot.port_P);
  connect(pilot.port_T, tank.port);
  connect(pilot.port_A, valve.port_x);
  connect(load.y, pilot.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.001, Tolerance = 1e-6));
end CartridgeValveExample;
