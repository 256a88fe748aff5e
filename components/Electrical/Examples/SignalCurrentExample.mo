within Electrical.Examples;
model SignalCurrentExample "A capacitor charged by a current"
  Signal.Ramp ramp(height = 1e-3, duration = 1);
  SignalCurrent source;
  Capacitor C(C = 1e-3);
  Ground ground;
equation
  connect(ramp.y, source.i);
  connect(source.n, C.p);
  connect(C.n, source.p);
  connect(C.n, ground.p);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end SignalCurrentExample;
