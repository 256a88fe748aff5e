within Electrical.Examples;
model SignalVoltageExample "A rectifier with a diode"
  Signal.Sine sine(amplitude = 10, f = 50);
  SignalVoltage source;
  Diode diode;
  Resistor R(R = 10);
  Capacitor C(C = 1e-3);
  Ground ground;
equation
  connect(sine.y, source.v);
  connect(source.p, diode.p);
  connect(diode.n, R.p);
  connect(R.n, source.n);
  connect(diode.n, C.p);
  connect(C.n, source.n);
  connect(source.n, ground.p);
  annotation(experiment(StartTime = 0, StopTime = 0.1, Interval = 0.0002, Tolerance = 1e-6));
end SignalVoltageExample;
