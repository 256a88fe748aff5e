within Pneumatic.Examples;
model Valve22Example "A valve fills a vessel in two steps"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5);
  Valve22 valve(C_max = 0.5e-8);
  Volume vessel(V = 2e-3);
  Signal.Pulse command(period = 0.5, width = 0.4, startTime = 0.1);
equation
  connect(supply.port, valve.port_1);
  connect(valve.port_2, vessel.port);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end Valve22Example;
