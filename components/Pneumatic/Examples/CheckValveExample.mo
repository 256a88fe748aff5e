within Pneumatic.Examples;
model CheckValveExample "A check valve keeps the highest pressure of a supply that swings"
  inner Gas gas "Air";
  PressureSource supply(useInput = true);
  Signal.Sine pressure(amplitude = 2e5, f = 1, offset = 4e5);
  CheckValve check(C_max = 0.5e-8);
  Volume vessel(V = 1e-3, p_start = 2e5);
equation
  connect(pressure.y, supply.p_in);
  connect(supply.port, check.port_a);
  connect(check.port_b, vessel.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end CheckValveExample;
