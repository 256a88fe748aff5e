within Signal.Examples;
model PadeDelayExample "Answer to a sine"
  Sine source(f = 2);
  PadeDelay block1(T = 0.05);
equation
  connect(source.y, block1.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end PadeDelayExample;
