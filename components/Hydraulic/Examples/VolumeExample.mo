within Hydraulic.Examples;
model VolumeExample "A volume filled by a constant flow"
  inner Oil.ISOVG46 oil "Oil";
  Volume volume(V = 1e-3);
  FlowSource source(q = 1e-5);
equation
  connect(source.port, volume.port);
  annotation(experiment(StartTime = 0, StopTime = 10, Interval = 0.02, Tolerance = 1e-6));
end VolumeExample;
