within Pneumatic.Examples;
model TubeExample "A vessel is filled through 5 m of tube"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5);
  Valve22 valve(C_max = 1e-8);
  Tube tube(L = 5, D = 4e-3, G = 1);
  Volume vessel(V = 0.5e-3);
  Signal.Step command(startTime = 0.1);
equation
  connect(supply.port, valve.port_1);
  connect(valve.port_2, tube.port_a);
  connect(tube.port_b, vessel.port);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end TubeExample;
