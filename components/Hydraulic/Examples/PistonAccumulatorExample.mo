within Hydraulic.Examples;
model PistonAccumulatorExample "A piston accumulator charged and discharged"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Sine sine(amplitude = 2e-4, f = 0.2);
  FlowSource source(useInput = true);
  PistonAccumulator accumulator(V_0 = 1e-3, p_pre = 50e5, p_start = 80e5);
equation
  connect(sine.y, source.q_in);
  connect(source.port, accumulator.port);
  annotation(experiment(StartTime = 0, StopTime = 30, Interval = 0.06, Tolerance = 1e-6));
end PistonAccumulatorExample;
