within Signal.Examples;
model FixedDelayExample "A pulse arrives later, and a sine too"
  Pulse pulse(period = 0.5);
  Sine sine(f = 2);
  FixedDelay late(delayTime = 0.1);
  FixedDelay lateSine(delayTime = 0.125);
equation
  connect(pulse.y, late.u);
  connect(sine.y, lateSine.u);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.01, Tolerance = 1e-6));
end FixedDelayExample;
