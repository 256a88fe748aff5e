within Pneumatic.Examples;
model ReceiverExample "Hot gas flows through a receiver, which cools it"
  inner Gas gas "Air";
  FlowSource compressor(m_flow = 5e-3, T = 363.15);
  Receiver receiver(V = 10e-3, G = 5, p_start = 6e5);
  Orifice consumer(C = 0.5e-8);
  Atmosphere atmosphere;
equation
  connect(compressor.port, receiver.port_a);
  connect(receiver.port_b, consumer.port_a);
  connect(consumer.port_b, atmosphere.port);
  annotation(experiment(StartTime = 0, StopTime = 20, Interval = 0.04, Tolerance = 1e-6));
end ReceiverExample;
