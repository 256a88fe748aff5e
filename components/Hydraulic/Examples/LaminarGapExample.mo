within Hydraulic.Examples;
model LaminarGapExample "A gap empties a volume"
  inner Oil.ISOVG46 oil "Oil";
  Volume volume(V = 1e-4, p_start = 100e5);
  LaminarGap gap(G = 1e-13);
  Tank tank;
equation
  connect(volume.port, gap.port_a);
  connect(gap.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end LaminarGapExample;
