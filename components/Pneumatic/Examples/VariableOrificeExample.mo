within Pneumatic.Examples;
model VariableOrificeExample "A throttle is opened by hand and lets a vessel out"
  inner Gas gas "Air";
  Volume vessel(V = 5e-3, p_start = 7e5);
  VariableOrifice throttle(C_max = 1e-8);
  Atmosphere atmosphere;
  Signal.Trapezoid command(rising = 0.5, holding = 0.5, falling = 0.5, startTime = 0.2);
equation
  connect(vessel.port, throttle.port_a);
  connect(throttle.port_b, atmosphere.port);
  connect(command.y, throttle.u);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end VariableOrificeExample;
