within Electrical.Examples;
model InductorExample "An oscillating circuit"
  ConstantVoltage source(V = 10);
  Resistor R(R = 1);
  Inductor L(L = 1e-3);
  Capacitor C(C = 1e-4);
  Ground ground;
  VoltageSensor voltage;
  CurrentSensor current;
equation
  connect(source.p, R.p);
  connect(R.n, current.p);
  connect(current.n, L.p);
  connect(L.n, C.p);
  connect(C.n, source.n);
  connect(source.n, ground.p);
  connect(voltage.p, C.p);
  connect(voltage.n, C.n);
  annotation(experiment(StartTime = 0, StopTime = 0.02, Interval = 4e-05, Tolerance = 1e-6));
end InductorExample;
