within Pneumatic.Examples;
model CylinderExample "A cylinder out and back, moved by a 5/2 way valve"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5);
  Atmosphere exhaust;
  Valve52 valve(C_max = 0.8e-8);
  Cylinder cylinder(p_2_start = 7e5, G_1 = 0.5, G_2 = 0.5, pistonLeakage = true);
  Mechanical.Translational.Mass load(m = 5, s(start = 0, fixed = false), v(fixed = false));
  Signal.Trapezoid command(rising = 1e-3, holding = 1, falling = 1e-3, startTime = 0.1);
equation
  connect(supply.port, valve.port_1);
  connect(valve.port_3, exhaust.port);
  connect(valve.port_5, exhaust.port);
  connect(valve.port_4, cylinder.port_1);
  connect(valve.port_2, cylinder.port_2);
  connect(cylinder.flange, load.flange_a);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end CylinderExample;
