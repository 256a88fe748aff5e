within Pneumatic.Examples;
model FlowSourceExample "A constant flow through a restriction into the atmosphere"
  inner Gas gas "Air";
  FlowSource source(useInput = true);
  Signal.Ramp delivery(height = 5e-3, duration = 1, startTime = 0.2);
  Volume vessel(V = 1e-3);
  Orifice orifice(C = 1e-8);
  Atmosphere atmosphere;
equation
  connect(delivery.y, source.m_flow_in);
  connect(source.port, vessel.port);
  connect(vessel.port, orifice.port_a);
  connect(orifice.port_b, atmosphere.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end FlowSourceExample;
