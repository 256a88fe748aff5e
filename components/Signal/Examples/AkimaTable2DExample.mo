within Signal.Examples;
model AkimaTable2DExample "Two signals combined"
  Sine source_1(f = 2);
  Sine source_2(f = 3, offset = 2);
  AkimaTable2D block1(table = [0, 0, 1, 2, 4; -1, 0, 0.5, 1, 2; 0, 1, 1, 2, 3; 1, 1, 2, 2, 4]);
equation
  connect(source_1.y, block1.u1);
  connect(source_2.y, block1.u2);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end AkimaTable2DExample;
