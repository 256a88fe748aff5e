within Signal.Examples;
model SumExample "Three signals summed"
  Sine source[3](f = {1, 2, 3});
  Sum block1(n = 3, k = {1, 0.5, 0.25});
equation
  connect(source.y, block1.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end SumExample;
