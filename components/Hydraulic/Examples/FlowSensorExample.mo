within Hydraulic.Examples;
model FlowSensorExample "A sensor at a volume that empties"
  inner Oil.ISOVG46 oil "Oil";
  Volume volume(V = 1e-3, p_start = 50e5);
  Orifice orifice(A = 1e-6);
  Tank tank;
  FlowSensor sensor;
  Tank outlet;
  Orifice out(A = 0.5e-6);
equation
  connect(volume.port, orifice.port_a);
  connect(orifice.port_b, tank.port);
  connect(volume.port, sensor.port_a);
  connect(sensor.port_b, out.port_a);
  connect(out.port_b, outlet.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end FlowSensorExample;
