within Hydraulic.Examples;
model TemperatureSensorExample "Warm oil replaces cold oil in a volume"
  inner Oil.ISOVG46 oil(thermal = true) "Oil";
  FlowSource source(q = 1e-4, dT = 20);
  Volume volume(V = 1e-3);
  TemperatureSensor sensor;
  Orifice outlet(A = 1e-5);
  Tank tank;
equation
  connect(source.port, volume.port);
  connect(volume.port, sensor.port);
  connect(volume.port, outlet.port_a);
  connect(outlet.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 60, Interval = 0.12, Tolerance = 1e-6));
end TemperatureSensorExample;
