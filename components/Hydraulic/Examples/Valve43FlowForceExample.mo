within Hydraulic.Examples;
model Valve43FlowForceExample "A cylinder moved by a directly operated valve"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 150e5);
  Tank tank;
  Valve43FlowForce valve;
  Cylinder cylinder(A_1 = 12.57e-4, A_2 = 8.77e-4, stroke = 0.4, s_start = 0.1, p_1_start = 20e5, p_2_start = 20e5);
  Mechanical.Translational.Mass load(m = 200, s(start = 0.1, fixed = false), v(fixed = false));
  Signal.TimeTable command(table = [0, 0; 0.1, 0; 0.2, 1; 1, 1; 1.1, -0.8; 2, -0.8]);
equation
  connect(source.port, valve.port_P);
  connect(valve.port_T, tank.port);
  connect(valve.port_A, cylinder.port_1);
  connect(valve.port_B, cylinder.port_2);
  connect(cylinder.flange, load.flange_a);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end Valve43FlowForceExample;
