within Signal.Examples;
model AkimaTableExample "Answer to a sine"
  Sine source(f = 2);
  AkimaTable block1(table = [-1, 0; -0.5, 0.1; 0, 0.5; 0.5, 0.9; 1, 1]);
equation
  connect(source.y, block1.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end AkimaTableExample;
