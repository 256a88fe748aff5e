within Signal.Examples;
model SmoothMoveExample "The signal, integrated"
  SmoothMove source(rising = 0.3, holding = 0.2, falling = 0.3);
  Integrator integral;
equation
  connect(source.y, integral.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end SmoothMoveExample;
