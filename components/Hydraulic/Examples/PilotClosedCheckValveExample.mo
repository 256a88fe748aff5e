within Hydraulic.Examples;
model PilotClosedCheckValveExample "A pilot stops the filling of a volume for a while"
  inner Oil.ISOVG46 oil "Oil";
  PressureSource source(useInput = true);
  Signal.Sine supply(amplitude = 20e5, offset = 40e5, f = 2);
  PilotClosedCheckValve valve(A_max = 1e-6);
  Volume volume(V = 1e-3, p_start = 1e5);
  LaminarGap leak;
  Tank tank;
  PressureSource pilot(useInput = true);
  Signal.TimeTable command(table = [0, 1e5; 1, 1e5; 1.01, 80e5; 2, 80e5; 2.01, 1e5; 3, 1e5]);
equation
  connect(supply.y, source.p_in);
  connect(source.port, valve.port_a);
  connect(valve.port_b, volume.port);
  connect(volume.port, leak.port_a);
  connect(leak.port_b, tank.port);
  connect(command.y, pilot.p_in);
  connect(pilot.port, valve.port_x);
  annotation(experiment(StartTime = 0, StopTime = 3, Interval = 0.006, Tolerance = 1e-6));
end PilotClosedCheckValveExample;
