within Hydraulic.Examples;
model CounterbalanceValveExample "A load is held, then let down by the pilot"
  inner Oil.ISOVG46 oil "Oil";
  Volume volume(V = 1e-3, p_start = 150e5);
  CounterbalanceValve valve(q_nom = 5e-5);
  Tank tank;
  PressureSource pilot(useInput = true);
  Signal.Step step(height = 60e5, offset = 1e5, startTime = 0.5);
equation
  connect(tank.port, valve.port_a);
  connect(valve.port_b, volume.port);
  connect(pilot.port, valve.port_x);
  connect(step.y, pilot.p_in);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end CounterbalanceValveExample;
