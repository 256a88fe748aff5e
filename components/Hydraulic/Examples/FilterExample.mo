within Hydraulic.Examples;
model FilterExample "Pressure drop of a clogged filter"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Ramp ramp(height = 1e-3, duration = 1);
  FlowSource source(useInput = true);
  Volume volume(V = 1e-5);
  Filter filter(clogging = 0.5);
  Tank tank;
equation
  connect(ramp.y, source.q_in);
  connect(source.port, volume.port);
  connect(volume.port, filter.port_a);
  connect(filter.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end FilterExample;
