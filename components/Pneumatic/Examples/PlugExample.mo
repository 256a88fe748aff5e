within Pneumatic.Examples;
model PlugExample "A way valve with its exhaust closed keeps the pressure"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5);
  Valve32 valve;
  Plug plug;
  Volume vessel(V = 1e-3);
  Signal.Trapezoid command(rising = 0.01, holding = 1, falling = 0.01, startTime = 0.1);
equation
  connect(supply.port, valve.port_1);
  connect(valve.port_2, vessel.port);
  connect(valve.port_3, plug.port);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end PlugExample;
