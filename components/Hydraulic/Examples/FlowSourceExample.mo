within Hydraulic.Examples;
model FlowSourceExample "Flow that reverses"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Sine sine(amplitude = 1e-5, f = 1);
  FlowSource source(useInput = true);
  Volume volume(V = 1e-3, p_start = 100e5);
equation
  connect(sine.y, source.q_in);
  connect(source.port, volume.port);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.006, Tolerance = 1e-6));
end FlowSourceExample;
