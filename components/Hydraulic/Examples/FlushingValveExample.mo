within Hydraulic.Examples;
model FlushingValveExample "The low side of a closed circuit is flushed"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Sine sine(amplitude = 30e5, f = 1, offset = 50e5);
  PressureSource side_a(useInput = true);
  PressureSource side_b(p = 50e5);
  FlushingValve valve;
  Tank tank;
equation
  connect(sine.y, side_a.p_in);
  connect(side_a.port, valve.port_a);
  connect(side_b.port, valve.port_b);
  connect(valve.port_out, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end FlushingValveExample;
