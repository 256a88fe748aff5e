within Hydraulic.Examples;
model SequenceValveExample "A second volume is filled when the first has its pressure"
  inner Oil.ISOVG46 oil "Oil";
  FlowSource pump(q = 5e-5);
  Volume first(V = 1e-3);
  SequenceValve valve(p_set = 100e5);
  Volume second(V = 1e-3);
  ReliefValve relief(p_set = 160e5);
  Tank tank;
equation
  connect(pump.port, first.port);
  connect(first.port, valve.port_a);
  connect(valve.port_b, second.port);
  connect(first.port, relief.port_a);
  connect(relief.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end SequenceValveExample;
