within Signal.Examples;
model NoiseExample "The signal, integrated"
  Noise source(samplePeriod = 0.01, seed = 42);
  Integrator integral;
equation
  connect(source.y, integral.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end NoiseExample;
