within Hydraulic.Examples;
model PressureReducerRelievingExample "A consumer takes oil and pushes it back"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 200e5);
  PressureReducerRelieving valve(p_set = 50e5);
  Volume volume(V = 2e-4, p_start = 50e5);
  FlowSource consumer(useInput = true);
  Signal.Sine course(amplitude = 3e-4, f = 2);
  Tank tank;
equation
  connect(source.port, valve.port_a);
  connect(valve.port_b, volume.port);
  connect(valve.port_t, tank.port);
  connect(course.y, consumer.q_in);
  connect(consumer.port, volume.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end PressureReducerRelievingExample;
