within Pneumatic.Examples;
model PressureRegulatorExample "A regulator holds the pressure of a vessel while gas is drawn, and lets out what is pushed in"
  inner Gas gas "Air";
  Reservoir supply(p = 9e5);
  PressureRegulator regulator(p_set = 5e5);
  Volume vessel(V = 1e-3);
  FlowSource load(useInput = true);
  Signal.TimeTable delivery(table = [0, 0; 1, 0; 1.1, -8e-3; 2, -8e-3; 2.1, 1e-3; 4, 1e-3]);
equation
  connect(supply.port, regulator.port_a);
  connect(regulator.port_b, vessel.port);
  connect(load.port, vessel.port);
  connect(delivery.y, load.m_flow_in);
  annotation(experiment(StartTime = 0, StopTime = 4, Interval = 0.008, Tolerance = 1e-6));
end PressureRegulatorExample;
