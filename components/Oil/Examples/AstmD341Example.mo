within Oil.Examples;
model AstmD341Example "Leakage through a gap over temperature"
  inner Oil.Fluid oil(useTemperatureInput = true, redeclare function viscosity = Oil.Viscosity.astmD341(nu_1 = 32e-6, nu_2 = 5.4e-6)) "Oil";
  Signal.Ramp temperature(height = 60, offset = 293.15, duration = 1);
  Hydraulic.PressureSource source(p = 200e5);
  Hydraulic.LaminarGap gap;
  Hydraulic.Tank tank;
equation
  connect(temperature.y, oil.T_in);
  connect(source.port, gap.port_a);
  connect(gap.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end AstmD341Example;
