within Hydraulic.Examples;
model Valve62Example "One directional valve serves two cylinders in turn"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 80e5);
  Tank tank;
  Valve43 valve(q_nom = 1e-4, overlap = 0.1);
  Valve62 selector(q_nom = 1e-4);
  Cylinder first(A_1 = 12.57e-4, A_2 = 8.77e-4, stroke = 0.2, s_start = 0.05, p_1_start = 20e5, p_2_start = 20e5);
  Cylinder second(A_1 = 12.57e-4, A_2 = 8.77e-4, stroke = 0.2, s_start = 0.1, p_1_start = 20e5, p_2_start = 20e5);
  Signal.TimeTable command(table = [0, 0; 0.1, 0; 0.15, 1; 0.7, 1; 0.75, 0; 0.9, 0; 0.95, -1; 1.4, -1; 1.45, 0; 1.6, 0]);
  Signal.Step change(startTime = 0.8);
equation
  connect(source.port, valve.port_P);
  connect(valve.port_T, tank.port);
  connect(valve.port_A, selector.port_1);
  connect(valve.port_B, selector.port_2);
  connect(selector.port_A1, first.port_1);
  connect(selector.port_A2, first.port_2);
  connect(selector.port_B1, second.port_1);
  connect(selector.port_B2, second.port_2);
  connect(command.y, valve.u);
  connect(change.y, selector.u);
  annotation(experiment(StartTime = 0, StopTime = 1.6, Interval = 0.004, Tolerance = 1e-6));
end Valve62Example;
