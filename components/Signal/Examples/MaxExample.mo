within Signal.Examples;
model MaxExample "Two signals combined"
  Sine source_1(f = 2);
  Sine source_2(f = 3, offset = 2);
  Max block1;
equation
  connect(source_1.y, block1.u1);
  connect(source_2.y, block1.u2);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end MaxExample;
