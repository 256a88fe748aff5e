within Signal.Examples;
model LimiterExample "Answer to a sine"
  Sine source(f = 2);
  Limiter block1(uMax = 0.5);
equation
  connect(source.y, block1.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end LimiterExample;
