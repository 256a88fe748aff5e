within Pneumatic.Examples;
model TemperatureSensorExample "Cold and hot gas are mixed in a node"
  inner Gas gas "Air";
  FlowSource cold(m_flow = 2e-3, T = 273.15);
  FlowSource hot(T = 373.15, useInput = true);
  Signal.Ramp delivery(height = 4e-3, duration = 1);
  TemperatureSensor sensor;
  Atmosphere atmosphere;
equation
  connect(delivery.y, hot.m_flow_in);
  connect(cold.port, atmosphere.port);
  connect(hot.port, atmosphere.port);
  connect(sensor.port, atmosphere.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end TemperatureSensorExample;
