within Hydraulic.Examples;
model LineFrictionExample "Water hammer with friction that knows the past of the flow, beside quasi-steady friction"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(p = 50e5);
  Line steady(L = 20, d = 1e-2, n = 20, p_start = 50e5, p_b_start = 43.5e5, m_flow_start = 0.168);
  Line unsteady(redeclare model Friction = LineFriction.Unsteady(k = 5), L = 20, d = 1e-2, n = 20, p_start = 50e5, p_b_start = 43.5e5, m_flow_start = 0.168);
  VariableOrifice valve_1(A_max = 3e-6);
  VariableOrifice valve_2(A_max = 3e-6);
  Signal.Ramp close(height = -1, offset = 1, duration = 2e-3, startTime = 0.1);
  Tank tank;
equation
  connect(source.port, steady.port_a);
  connect(steady.port_b, valve_1.port_a);
  connect(valve_1.port_b, tank.port);
  connect(source.port, unsteady.port_a);
  connect(unsteady.port_b, valve_2.port_a);
  connect(valve_2.port_b, tank.port);
  connect(close.y, valve_1.u);
  connect(close.y, valve_2.u);
  annotation(experiment(StartTime = 0, StopTime = 0.6, Interval = 1e-3, Tolerance = 1e-6));
end LineFrictionExample;
