within Signal.Bases;
partial block Sampled "One input, one output, acting at sampling instants"
  extends OneToOne;
  parameter SI.Time samplePeriod(min = 1e-9, nominal = 1e-3) = 1e-3 "Sampling period";
  parameter SI.Time startTime = 0 "First sample";
protected
  Boolean tick "true at a sampling instant";
equation
  assert(samplePeriod > 0, "The sampling period must be positive");
  tick = sample(startTime, samplePeriod);
end Sampled;
