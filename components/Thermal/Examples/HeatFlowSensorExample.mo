within Thermal.Examples;
model HeatFlowSensorExample "Heat between two bodies"
  HeatCapacitor hot(C = 500, T(start = 350));
  ThermalConductor wall(G = 2);
  HeatFlowSensor sensor;
  HeatCapacitor cold(C = 1000);
equation
  connect(hot.port, wall.port_a);
  connect(wall.port_b, sensor.port_a);
  connect(sensor.port_b, cold.port);
  annotation(experiment(StartTime = 0, StopTime = 1000, Interval = 2, Tolerance = 1e-6));
end HeatFlowSensorExample;
