within Hydraulic.Examples;
model ShuttleValveExample "The higher of two pressures reaches the outlet"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Sine sine(amplitude = 10e5, f = 1, offset = 50e5);
  PressureSource source_a(useInput = true);
  PressureSource source_b(p = 50e5);
  ShuttleValve shuttle;
  Volume volume(V = 1e-5, p_start = 50e5);
  LaminarGap load(G = 1e-12);
  Tank tank;
equation
  connect(sine.y, source_a.p_in);
  connect(source_a.port, shuttle.port_a);
  connect(source_b.port, shuttle.port_b);
  connect(shuttle.port_out, volume.port);
  connect(volume.port, load.port_a);
  connect(load.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end ShuttleValveExample;
