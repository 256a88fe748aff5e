within Hydraulic.Examples;
model WaterCoolerExample "Water cools oil that comes in hot, its valve opening"
  inner Oil.ISOVG46 oil(thermal = true) "Oil";
  FlowSource source(q = 5e-4, dT = 20);
  WaterCooler cooler(useInput = true);
  Tank tank;
  Signal.Ramp valve(height = 1, duration = 10);
equation
  connect(source.port, cooler.port_a);
  connect(cooler.port_b, tank.port);
  connect(valve.y, cooler.u);
  annotation(experiment(StartTime = 0, StopTime = 10, Interval = 0.02, Tolerance = 1e-6));
end WaterCoolerExample;
