within Signal.Examples;
model SequenceExample "A cylinder's cycle by limit switches: out, wait, back, and again"
  LimIntegrator position(k = 0.2, yMin = 0, yMax = 0.3) "Stroke of 0.3 m at 0.2 m/s";
  GreaterThreshold outside(threshold = 0.299);
  LessThreshold inside(threshold = 0.001);
  OnDelay waited(delay = 0.5);
  FlipFlop forward(y_start = true);
  EdgeCounter strokes;
  TriggeredSampler lastStroke;
  Clock clock;
  BooleanToReal command(realTrue = 1, realFalse = -1);
equation
  connect(forward.y, command.u);
  connect(command.y, position.u);
  connect(position.y, outside.u);
  connect(position.y, inside.u);
  connect(outside.y, waited.u);
  connect(inside.y, forward.set);
  connect(waited.y, forward.reset);
  connect(waited.y, strokes.u);
  connect(clock.y, lastStroke.u);
  connect(waited.y, lastStroke.trigger);
  annotation(experiment(StartTime = 0, StopTime = 12, Interval = 0.02, Tolerance = 1e-6));
end SequenceExample;
