within Signal.Examples;
model TransferFunctionExample "Answer to a sine"
  Sine source(f = 2);
  TransferFunction block1(b = {1, 5}, a = {1, 2, 30});
equation
  connect(source.y, block1.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end TransferFunctionExample;
