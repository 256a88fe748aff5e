within Hydraulic.Examples;
model PressureSensorExample "A sensor at a volume that empties"
  inner Oil.ISOVG46 oil "Oil";
  Volume volume(V = 1e-3, p_start = 50e5);
  Orifice orifice(A = 1e-6);
  Tank tank;
  PressureSensor sensor;
equation
  connect(volume.port, orifice.port_a);
  connect(orifice.port_b, tank.port);
  connect(volume.port, sensor.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end PressureSensorExample;
