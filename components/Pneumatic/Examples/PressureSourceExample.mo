within Pneumatic.Examples;
model PressureSourceExample "A pressure that swings drives gas to and fro through a restriction"
  inner Gas gas "Air";
  PressureSource source(useInput = true);
  Signal.Sine pressure(amplitude = 1e5, f = 2, offset = 3e5);
  Orifice orifice(C = 0.5e-8);
  Volume vessel(V = 1e-3, p_start = 3e5);
equation
  connect(pressure.y, source.p_in);
  connect(source.port, orifice.port_a);
  connect(orifice.port_b, vessel.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end PressureSourceExample;
