within Signal.Examples;
model SamplerExample "Answer to a sine"
  Sine source(f = 2);
  Sampler block1(samplePeriod = 0.05);
equation
  connect(source.y, block1.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end SamplerExample;
