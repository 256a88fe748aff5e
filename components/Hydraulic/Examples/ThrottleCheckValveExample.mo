within Hydraulic.Examples;
model ThrottleCheckValveExample "Slow one way, fast the other"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Sine sine(amplitude = 20e5, f = 1, offset = 50e5);
  PressureSource source(useInput = true);
  ThrottleCheckValve valve(A = 0.2e-6);
  Volume volume(V = 1e-3, p_start = 50e5);
equation
  connect(sine.y, source.p_in);
  connect(source.port, valve.port_a);
  connect(valve.port_b, volume.port);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.006, Tolerance = 1e-6));
end ThrottleCheckValveExample;
