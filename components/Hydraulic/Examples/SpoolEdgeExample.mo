within Hydraulic.Examples;
model SpoolEdgeExample "Flow over spool travel"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 100e5);
  SpoolEdge edge(overlap = 0.1);
  Tank tank;
  Signal.Ramp ramp(height = 2, offset = -1, duration = 1);
equation
  connect(source.port, edge.port_a);
  connect(edge.port_b, tank.port);
  connect(ramp.y, edge.x);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end SpoolEdgeExample;
