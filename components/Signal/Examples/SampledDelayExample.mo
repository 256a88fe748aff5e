within Signal.Examples;
model SampledDelayExample "Answer to a sine"
  Sine source(f = 2);
  SampledDelay block1(n = 3, samplePeriod = 0.02);
equation
  connect(source.y, block1.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end SampledDelayExample;
