within Signal.Examples;
model SecondOrderExample "Answer to a sine"
  Sine source(f = 2);
  SecondOrder block1(w = 20, D = 0.3);
equation
  connect(source.y, block1.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end SecondOrderExample;
