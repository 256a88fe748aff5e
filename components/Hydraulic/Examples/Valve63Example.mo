within Hydraulic.Examples;
model Valve63Example "An open-centre valve moves a cylinder: the by-pass takes what the cylinder does not"
  inner Oil.ISOVG46 oil "Oil";
  FlowSource pump(q = 5e-4);
  ReliefValve relief(p_set = 150e5, q_nom = 1e-3);
  Volume line(V = 2e-4, p_start = 2e5);
  CheckValve check;
  Valve63 valve(q_nom = 5e-4, q_C = 5e-4);
  Cylinder cylinder(A_1 = 12.57e-4, A_2 = 8.77e-4, stroke = 0.4, s_start = 0.1, p_1_start = 11.5e5, p_2_start = 5e5);
  Mechanical.Translational.ConstantForce load(f_constant = -1e3);
  Tank tank;
  Signal.TimeTable command(table = [0, 0; 0.2, 0; 0.8, 1; 1, 1; 1.1, 0; 1.4, 0; 1.6, -0.6; 1.9, -0.6; 2, 0; 2.2, 0]);
equation
  connect(pump.port, line.port);
  connect(line.port, relief.port_a);
  connect(relief.port_b, tank.port);
  connect(line.port, valve.port_P1);
  connect(valve.port_C, tank.port);
  connect(line.port, check.port_a);
  connect(check.port_b, valve.port_P);
  connect(valve.port_T, tank.port);
  connect(valve.port_A, cylinder.port_1);
  connect(valve.port_B, cylinder.port_2);
  connect(cylinder.flange, load.flange);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 2.2, Interval = 0.005, Tolerance = 1e-6));
end Valve63Example;
