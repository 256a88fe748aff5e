within Signal.Examples;
model LogicExample "Switching by logic"
  Sine source(f = 2);
  GreaterThreshold high(threshold = 0.5);
  BooleanStep gate(startTime = 0.5);
  And both;
  Or either;
  Not none;
  Switch choice;
  Constant zero(k = 0);
equation
  connect(source.y, high.u);
  connect(high.y, both.u1);
  connect(gate.y, both.u2);
  connect(high.y, either.u1);
  connect(gate.y, either.u2);
  connect(either.y, none.u);
  connect(source.y, choice.u1);
  connect(both.y, choice.u2);
  connect(zero.y, choice.u3);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end LogicExample;
