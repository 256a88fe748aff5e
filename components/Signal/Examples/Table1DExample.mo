within Signal.Examples;
model Table1DExample "Answer to a sine"
  Sine source(f = 2);
  Table1D block1(table = [-1, 0; 0, 0.5; 1, 0]);
equation
  connect(source.y, block1.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end Table1DExample;
