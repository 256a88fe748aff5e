within Hydraulic.Examples;
model FlowControlExample "A pump holds its flow while its speed falls, then meets the cut-off"
  inner Oil.ISOVG46 oil "Oil";
  Signal.TimeTable speed(table = [0, 200; 0.8, 200; 1.4, 120; 4, 120]);
  Mechanical.Rotational.Speed drive;
  Pump pump(V = 45e-6, G = 1e-12, useInput = true);
  PumpControl.FlowControl control(p_set = 200e5, V = pump.V, G = 1e-12, u_start = 0);
  Mechanical.Rotational.SpeedSensor sensor;
  Signal.TimeTable delivery(table = [0, 0; 0.1, 0; 0.3, 6e-4; 4, 6e-4]);
  Volume volume(V = 5e-4, p_start = 2e5);
  VariableOrifice load(A_max = 1.2e-5);
  Signal.Ramp closing(height = -0.95, offset = 1, duration = 1, startTime = 1.6);
  Tank tank;
equation
  connect(speed.y, drive.w_ref);
  connect(drive.flange, pump.flange);
  connect(sensor.flange, drive.flange);
  connect(sensor.w, control.w);
  connect(delivery.y, control.q_ref);
  connect(pump.port_b, tank.port);
  connect(pump.port_a, volume.port);
  connect(control.port_p, volume.port);
  connect(control.u, pump.u);
  connect(volume.port, load.port_a);
  connect(load.port_b, tank.port);
  connect(closing.y, load.u);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.005, Tolerance = 1e-6));
end FlowControlExample;
