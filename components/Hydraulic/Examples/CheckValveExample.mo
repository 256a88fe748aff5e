within Hydraulic.Examples;
model CheckValveExample "A check valve rectifies an alternating flow of pressure"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Sine sine(amplitude = 5e5, f = 2, offset = 20e5);
  PressureSource source(useInput = true);
  CheckValve valve;
  Volume volume(V = 1e-4, p_start = 20e5);
  LaminarGap load(G = 1e-11);
  Tank tank;
equation
  connect(sine.y, source.p_in);
  connect(source.port, valve.port_a);
  connect(valve.port_b, volume.port);
  connect(volume.port, load.port_a);
  connect(load.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end CheckValveExample;
