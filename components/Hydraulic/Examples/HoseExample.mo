within Hydraulic.Examples;
model HoseExample "Pressure behind a hose"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Sine sine(amplitude = 20e5, f = 10, offset = 100e5);
  PressureSource source(useInput = true);
  Hose hose(L = 2, d = 8e-3, p_start = 100e5);
  Volume volume(V = 1e-4, p_start = 100e5);
  Orifice load(A = 0.5e-6);
  Tank tank;
equation
  connect(sine.y, source.p_in);
  connect(source.port, hose.port_a);
  connect(hose.port_b, volume.port);
  connect(volume.port, load.port_a);
  connect(load.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end HoseExample;
