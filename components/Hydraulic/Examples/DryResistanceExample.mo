within Hydraulic.Examples;
model DryResistanceExample "A piston in a pipe: what swings within its friction stays behind"
  inner Oil.ISOVG46 oil "Oil";
  FlowSource source(useInput = true);
  Signal.Sine swing(amplitude = 1e-5, f = 1);
  Volume before(V = 1e-4, p_start = 20e5);
  DryResistance piston(dp_friction = 2e5);
  Orifice outlet(A = 5e-6);
  Tank tank(p = 20e5);
equation
  connect(swing.y, source.q_in);
  connect(source.port, before.port);
  connect(before.port, piston.port_a);
  connect(piston.port_b, outlet.port_a);
  connect(outlet.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.01, Tolerance = 1e-6));
end DryResistanceExample;
