within Thermal.Examples;
model HeatSourceExample "Constant heating against the surroundings"
  HeatSource heater(Q_flow = 100);
  HeatCapacitor body(C = 500);
  ThermalConductor way(G = 5);
  FixedTemperature ambient;
equation
  connect(heater.port, body.port);
  connect(body.port, way.port_a);
  connect(way.port_b, ambient.port);
  annotation(experiment(StartTime = 0, StopTime = 500, Interval = 1, Tolerance = 1e-6));
end HeatSourceExample;
