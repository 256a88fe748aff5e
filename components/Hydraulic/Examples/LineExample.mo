within Hydraulic.Examples;
model LineExample "Water hammer in a long line: its valve closes"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 50e5);
  Line line(L = 20, d = 1e-2, n = 10, p_start = 49e5, m_flow_start = 0.2);
  Volume volume(V = 5e-5, p_start = 49e5);
  VariableOrifice valve(A_max = 3e-6);
  Signal.Step close(height = -1, offset = 1, startTime = 0.5);
  Tank tank;
equation
  connect(source.port, line.port_a);
  connect(line.port_b, volume.port);
  connect(volume.port, valve.port_a);
  connect(valve.port_b, tank.port);
  connect(close.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.001, Tolerance = 1e-6));
end LineExample;
