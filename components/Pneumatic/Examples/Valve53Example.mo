within Pneumatic.Examples;
model Valve53Example "A 5/3 way valve moves a cylinder, stops it half way, and goes on"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5);
  Atmosphere exhaust;
  Valve53 valve(C_max = 0.5e-8);
  Cylinder cylinder(s_start = 0.02, p_1_start = 3.5e5, p_2_start = 4e5);
  Mechanical.Translational.Mass load(m = 5, s(start = 0.02, fixed = false), v(fixed = false));
  Signal.TimeTable command(table = [0, 0; 0.2, 0; 0.21, 0.4; 0.45, 0.4; 0.46, 0; 1, 0; 1.01, -0.5; 2, -0.5]);
equation
  connect(supply.port, valve.port_1);
  connect(valve.port_3, exhaust.port);
  connect(valve.port_5, exhaust.port);
  connect(valve.port_4, cylinder.port_1);
  connect(valve.port_2, cylinder.port_2);
  connect(cylinder.flange, load.flange_a);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end Valve53Example;
