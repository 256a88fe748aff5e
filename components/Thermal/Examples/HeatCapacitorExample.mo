within Thermal.Examples;
model HeatCapacitorExample "Two bodies exchange heat"
  HeatCapacitor hot(C = 100, T_start = 350);
  ThermalConductor way(G = 5);
  HeatCapacitor cold(C = 200);
  TemperatureSensor sensor;
equation
  connect(hot.port, way.port_a);
  connect(way.port_b, cold.port);
  connect(cold.port, sensor.port);
  annotation(experiment(StartTime = 0, StopTime = 100, Interval = 0.2, Tolerance = 1e-6));
end HeatCapacitorExample;
