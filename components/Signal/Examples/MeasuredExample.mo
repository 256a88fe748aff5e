within Signal.Examples;
model MeasuredExample "Answer to a sine"
  Sine source(f = 2);
  Measured block1(std = 0.01, offset = 0.1, delay = 2);
equation
  connect(source.y, block1.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end MeasuredExample;
