within Hydraulic.Examples;
model Valve32Example "A consumer filled and emptied"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 100e5);
  Valve32 valve;
  Tank tank;
  Volume volume(V = 1e-3);
  Signal.Pulse pulse(period = 0.5);
equation
  connect(source.port, valve.port_P);
  connect(valve.port_T, tank.port);
  connect(valve.port_A, volume.port);
  connect(pulse.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end Valve32Example;
