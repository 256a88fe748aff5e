within Pneumatic.Examples;
model SpoolEdgeExample "The flow of one edge over the travel of its spool"
  inner Gas gas "Air";
  Reservoir supply(p = 7e5);
  SpoolEdge edge(overlap = 0.1);
  Atmosphere atmosphere;
  Signal.Ramp travel(height = 2, duration = 1, offset = -1);
equation
  connect(supply.port, edge.port_a);
  connect(edge.port_b, atmosphere.port);
  connect(travel.y, edge.x);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end SpoolEdgeExample;
