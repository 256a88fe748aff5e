within Hydraulic.Examples;
model PowerSensorExample "Power into an orifice"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Sine sine(amplitude = 50e5, f = 1, offset = 80e5);
  PressureSource source(useInput = true);
  PowerSensor sensor;
  Orifice load(A = 5e-6);
  Tank tank;
equation
  connect(sine.y, source.p_in);
  connect(source.port, sensor.port_a);
  connect(sensor.port_b, load.port_a);
  connect(load.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end PowerSensorExample;
