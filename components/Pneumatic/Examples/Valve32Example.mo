within Pneumatic.Examples;
model Valve32Example "A valve fills and empties a vessel"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5);
  Valve32 valve(C_max = 0.5e-8);
  Atmosphere exhaust;
  Volume vessel(V = 1e-3);
  Signal.Trapezoid command(rising = 1e-3, holding = 1, falling = 1e-3, startTime = 0.1);
equation
  connect(supply.port, valve.port_1);
  connect(valve.port_2, vessel.port);
  connect(valve.port_3, exhaust.port);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 2.5, Interval = 0.005, Tolerance = 1e-6));
end Valve32Example;
