within Hydraulic.Examples;
model Valve42Example "A cylinder goes out and back"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 80e5);
  Tank tank;
  Valve42 valve(q_nom = 1e-4);
  Cylinder cylinder(A_1 = 12.57e-4, A_2 = 8.77e-4, stroke = 0.2, s_start = 0.05, p_1_start = 5e5, p_2_start = 5e5);
  Mechanical.Translational.Mass load(m = 50, s(start = 0.05, fixed = false), v(fixed = false));
  Signal.Pulse pulse(period = 2, startTime = 0.2);
equation
  connect(source.port, valve.port_P);
  connect(valve.port_T, tank.port);
  connect(valve.port_A, cylinder.port_1);
  connect(valve.port_B, cylinder.port_2);
  connect(cylinder.flange, load.flange_a);
  connect(pulse.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 2.5, Interval = 0.005, Tolerance = 1e-6));
end Valve42Example;
