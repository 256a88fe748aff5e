within Electrical.Examples;
model ResistorExample "A winding that warms"
  ConstantVoltage source(V = 10);
  Resistor winding(R = 1, alpha = 0.0039, useHeatPort = true);
  Ground ground;
  Thermal.HeatCapacitor body(C = 50);
  Thermal.ThermalConductor way(G = 1);
  Thermal.FixedTemperature ambient;
equation
  connect(source.p, winding.p);
  connect(winding.n, source.n);
  connect(source.n, ground.p);
  connect(winding.heatPort, body.port);
  connect(body.port, way.port_a);
  connect(way.port_b, ambient.port);
  annotation(experiment(StartTime = 0, StopTime = 300, Interval = 0.6, Tolerance = 1e-6));
end ResistorExample;
