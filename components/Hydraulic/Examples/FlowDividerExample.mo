within Hydraulic.Examples;
model FlowDividerExample "A flow is divided and then combined, two to one, against loads that change"
  inner Oil.ISOVG46 oil "Oil";
  FlowSource pump(useInput = true);
  Signal.TimeTable delivery(table = [0, 6e-4; 1, 6e-4; 1.2, -6e-4; 2.2, -6e-4]);
  Volume common(V = 2e-4, p_start = 60e5);
  FlowDivider divider(share = 2/3, q_nom = 6e-4);
  PressureSource consumer_A(useInput = true);
  PressureSource consumer_B(p = 50e5);
  Signal.TimeTable load(table = [0, 50e5; 0.2, 20e5; 0.4, 20e5; 0.6, 120e5; 0.8, 120e5; 1, 50e5; 1.4, 50e5; 1.6, 40e5; 1.8, 40e5; 2, 120e5; 2.2, 120e5]);
equation
  connect(delivery.y, pump.q_in);
  connect(pump.port, common.port);
  connect(common.port, divider.port_P);
  connect(divider.port_A, consumer_A.port);
  connect(divider.port_B, consumer_B.port);
  connect(load.y, consumer_A.p_in);
  annotation(experiment(StartTime = 0, StopTime = 2.2, Interval = 0.004, Tolerance = 1e-6));
end FlowDividerExample;
