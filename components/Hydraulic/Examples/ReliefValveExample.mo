within Hydraulic.Examples;
model ReliefValveExample "A relief valve limits the pressure of a growing flow"
  inner Oil.ISOVG46 oil "Oil";
  Signal.Ramp ramp(height = 4e-4, duration = 1);
  FlowSource source(useInput = true);
  Volume volume(V = 2e-4);
  ReliefValve valve(p_set = 100e5, q_nom = 5e-4);
  Tank tank;
equation
  connect(ramp.y, source.q_in);
  connect(source.port, volume.port);
  connect(volume.port, valve.port_a);
  connect(valve.port_b, tank.port);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end ReliefValveExample;
