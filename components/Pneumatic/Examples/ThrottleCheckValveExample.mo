within Pneumatic.Examples;
model ThrottleCheckValveExample "A cylinder whose exhaust is throttled moves evenly"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5);
  Atmosphere exhaust;
  Valve52 valve(C_max = 0.8e-8);
  ThrottleCheckValve speed_1(C = 0.15e-8);
  ThrottleCheckValve speed_2(C = 0.15e-8);
  Cylinder cylinder(p_2_start = 7e5);
  Mechanical.Translational.Mass load(m = 5, s(start = 0, fixed = false), v(fixed = false));
  Signal.Trapezoid command(rising = 1e-3, holding = 1.5, falling = 1e-3, startTime = 0.1);
equation
  connect(supply.port, valve.port_1);
  connect(valve.port_3, exhaust.port);
  connect(valve.port_5, exhaust.port);
  connect(valve.port_4, speed_1.port_b);
  connect(speed_1.port_a, cylinder.port_1);
  connect(valve.port_2, speed_2.port_b);
  connect(speed_2.port_a, cylinder.port_2);
  connect(cylinder.flange, load.flange_a);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 3.5, Interval = 0.007, Tolerance = 1e-6));
end ThrottleCheckValveExample;
