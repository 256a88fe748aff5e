within Hydraulic.Examples;
model JunctionExample "Flow divides at a junction"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Sine sine(amplitude = 2e-4, f = 1, offset = 3e-4);
  FlowSource source(useInput = true);
  Junction junction;
  Orifice load_b(A = 5e-6);
  Orifice load_c(A = 10e-6);
  Tank tank;
equation
  connect(sine.y, source.q_in);
  connect(source.port, junction.port_a);
  connect(junction.port_b, load_b.port_a);
  connect(junction.port_c, load_c.port_a);
  connect(load_b.port_b, tank.port);
  connect(load_c.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end JunctionExample;
