within Hydraulic.Examples;
model PressureSourceExample "Pressure that follows a sine"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Sine sine(amplitude = 5e5, f = 2, offset = 20e5);
  PressureSource source(useInput = true);
  Orifice orifice(A = 1e-6);
  Volume volume(V = 1e-4, p_start = 20e5);
equation
  connect(sine.y, source.p_in);
  connect(source.port, orifice.port_a);
  connect(orifice.port_b, volume.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end PressureSourceExample;
