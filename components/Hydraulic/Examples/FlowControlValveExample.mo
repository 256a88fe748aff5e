within Hydraulic.Examples;
model FlowControlValveExample "Half the flow into a load that rises and falls"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 200e5);
  FlowControlValve valve(q_nom = 5e-4);
  Signal.Constant command(k = 0.5);
  PressureSource load(useInput = true);
  Signal.Trapezoid course(offset = 5e5, amplitude = 190e5, rising = 0.4, holding = 0.1, falling = 0.4, startTime = 0.05);
equation
  connect(source.port, valve.port_a);
  connect(command.y, valve.u);
  connect(valve.port_b, load.port);
  connect(course.y, load.p_in);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end FlowControlValveExample;
