within Hydraulic.Examples;
model ProportionalReliefExample "The set pressure follows a command"
  inner Oil.ISOVG46 oil "Oil";
  FlowSource source(q = 2e-4);
  Volume volume(V = 2e-4);
  ProportionalRelief valve(k_u = 2e6);
  Signal.Step command(height = 3, offset = 3, startTime = 0.5);
  Tank tank;
equation
  connect(source.port, volume.port);
  connect(volume.port, valve.port_a);
  connect(valve.port_b, tank.port);
  connect(command.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end ProportionalReliefExample;
