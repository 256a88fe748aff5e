within Oil.Examples;
model ExponentialExample "Leakage through a gap over temperature"
  inner Oil.Fluid oil(useTemperatureInput = true) "Oil";
  Signal.Ramp temperature(height = 60, offset = 293.15, duration = 1);
  Hydraulic.PressureSource source(p = 200e5);
  Hydraulic.LaminarGap gap;
  Hydraulic.Tank tank;
equation
  connect(temperature.y, oil.T_in);
  connect(source.port, gap.port_a);
  connect(gap.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end ExponentialExample;
