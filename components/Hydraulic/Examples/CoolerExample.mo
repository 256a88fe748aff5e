within Hydraulic.Examples;
model CoolerExample "Losses of a relief valve warm the oil, a cooler takes the heat"
  inner Oil.ISOVG46 oil(useTemperatureInput = true) "Oil, its temperature from the heat balance";
  FlowSource source(q = 3e-4);
  Volume volume(V = 2e-4);
  ReliefValve valve(p_set = 100e5, useHeatPort = true);
  Cooler cooler;
  Tank tank;
  Thermal.OilMass heat(C = 20e3);
equation
  connect(source.port, volume.port);
  connect(volume.port, valve.port_a);
  connect(valve.port_b, cooler.port_a);
  connect(cooler.port_b, tank.port);
  connect(valve.heatPort, heat.port);
  connect(cooler.oilHeat, heat.port);
  connect(heat.T, oil.T_in);
  annotation(experiment(StartTime = 0, StopTime = 600, Interval = 1.2, Tolerance = 1e-6));
end CoolerExample;
