within Electrical.Examples;
model SwitchExample "A coil switched, with a free-wheeling diode"
  ConstantVoltage source(V = 24);
  Switch switch1;
  Signal.Pulse pulse(period = 0.01);
  Signal.GreaterThreshold on(threshold = 0.5);
  Inductor L(L = 10e-3);
  Resistor R(R = 5);
  Diode diode;
  Ground ground;
equation
  connect(pulse.y, on.u);
  connect(on.y, switch1.closed);
  connect(source.p, switch1.p);
  connect(switch1.n, L.p);
  connect(L.n, R.p);
  connect(R.n, source.n);
  connect(diode.p, source.n);
  connect(diode.n, switch1.n);
  connect(source.n, ground.p);
  annotation(experiment(StartTime = 0, StopTime = 0.05, Interval = 0.0001, Tolerance = 1e-6));
end SwitchExample;
