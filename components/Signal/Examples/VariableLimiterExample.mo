within Signal.Examples;
model VariableLimiterExample "A sine between moving limits"
  Sine source(f = 2);
  Ramp upper(height = 1);
  Gain lower(k = -1);
  VariableLimiter limiter;
equation
  connect(source.y, limiter.u);
  connect(upper.y, limiter.limit1);
  connect(upper.y, lower.u);
  connect(lower.y, limiter.limit2);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end VariableLimiterExample;
