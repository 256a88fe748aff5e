within Hydraulic.Examples;
model PipeResistanceExample "Friction of a pipe from laminar to turbulent"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Ramp ramp(height = 1e-3, duration = 1);
  FlowSource source(useInput = true);
  Volume volume(V = 1e-5);
  PipeResistance pipe(L = 2, d = 1e-2);
  Tank tank;
equation
  connect(ramp.y, source.q_in);
  connect(source.port, volume.port);
  connect(volume.port, pipe.port_a);
  connect(pipe.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end PipeResistanceExample;
