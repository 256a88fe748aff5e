within Hydraulic.Examples;
model TankExample "A tank empties a volume through an orifice"
  inner Oil.ISOVG46 oil "Oil";
  Volume volume(V = 1e-3, p_start = 50e5);
  Orifice orifice(A = 1e-6);
  Tank tank;
equation
  connect(volume.port, orifice.port_a);
  connect(orifice.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end TankExample;
