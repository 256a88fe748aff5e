within Electrical.Examples;
model PowerSensorExample "Power of a coil with resistance"
  Signal.Sine sine(amplitude = 10, f = 5);
  SignalVoltage source;
  PowerSensor sensor;
  Resistor resistor(R = 2);
  Inductor inductor(L = 0.05);
  Ground ground;
equation
  connect(sine.y, source.v);
  connect(source.p, sensor.pc);
  connect(sensor.nc, resistor.p);
  connect(resistor.n, inductor.p);
  connect(inductor.n, source.n);
  connect(sensor.pv, source.p);
  connect(sensor.nv, source.n);
  connect(source.n, ground.p);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end PowerSensorExample;
