within Hydraulic.Examples;
model LineExample "Water hammer in a long line: its valve closes"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 50e5);
  Line line(L = 20, d = 1e-2, n = 20, p_start = 50e5, p_b_start = 43.5e5, m_flow_start = 0.168);
  VariableOrifice valve(A_max = 3e-6);
  Signal.Ramp close(height = -1, offset = 1, duration = 2e-3, startTime = 0.1);
  Tank tank;
equation
  connect(source.port, line.port_a);
  connect(line.port_b, valve.port_a);
  connect(valve.port_b, tank.port);
  connect(close.y, valve.u);
  annotation(experiment(StartTime = 0, StopTime = 0.6, Interval = 5e-4, Tolerance = 1e-6));
end LineExample;
