within Oil.Examples;
model WaterGlycolExample "Leakage and stiffness with this fluid"
  inner Oil.WaterGlycol oil "Fluid";
  Hydraulic.Volume volume(V = 1e-4, p_start = 200e5);
  Hydraulic.LaminarGap gap;
  Hydraulic.Tank tank;
equation
  connect(volume.port, gap.port_a);
  connect(gap.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end WaterGlycolExample;
