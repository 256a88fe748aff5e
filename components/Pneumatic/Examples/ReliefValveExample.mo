within Pneumatic.Examples;
model ReliefValveExample "A relief valve limits the pressure of a vessel"
  inner Gas gas "Air";
  FlowSource source(m_flow = 5e-3);
  Volume vessel(V = 5e-3, p_start = 4e5);
  ReliefValve relief(p_set = 7e5);
  Atmosphere atmosphere;
equation
  connect(source.port, vessel.port);
  connect(vessel.port, relief.port_a);
  connect(relief.port_b, atmosphere.port);
  annotation(experiment(StartTime = 0, StopTime = 10, Interval = 0.02, Tolerance = 1e-6));
end ReliefValveExample;
