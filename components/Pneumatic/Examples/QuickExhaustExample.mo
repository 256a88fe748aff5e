within Pneumatic.Examples;
model QuickExhaustExample "A vessel is filled through a valve and emptied straight to the outside"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5);
  Valve32 valve(C_max = 0.5e-8);
  Atmosphere exhaust;
  Volume line(V = 2e-5);
  QuickExhaust quick(C_12 = 0.5e-8, C_23 = 2e-8);
  Silencer silencer;
  Volume vessel(V = 1e-3);
  Signal.Trapezoid command(rising = 1e-3, holding = 2, falling = 1e-3, startTime = 0.1);
equation
  connect(supply.port, valve.port_1);
  connect(valve.port_3, exhaust.port);
  connect(valve.port_2, line.port);
  connect(line.port, quick.port_1);
  connect(quick.port_2, vessel.port);
  connect(quick.port_3, silencer.port);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.006, Tolerance = 1e-6));
end QuickExhaustExample;
