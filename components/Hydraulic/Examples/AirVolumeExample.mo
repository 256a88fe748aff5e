within Hydraulic.Examples;
model AirVolumeExample "A volume pressed, held and released: its air dissolves and comes back"
  inner Oil.ISOVG46 oil "Oil";
  AirVolume volume(V = 1e-3, p_start = 1e5, x_start = 1);
  FlowSource source(useInput = true);
  Signal.TimeTable pulses(table = [0, 0; 1, 0; 1, 2e-5; 2, 2e-5; 2, 0; 60, 0; 60, -2e-5; 61, -2e-5; 61, 0; 100, 0]);
equation
  connect(pulses.y, source.q_in);
  connect(source.port, volume.port);
  annotation(experiment(StartTime = 0, StopTime = 90, Interval = 0.18, Tolerance = 1e-6));
end AirVolumeExample;
