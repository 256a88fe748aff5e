within Hydraulic.Examples;
model VolumeExample "A volume filled by a constant flow"
  inner Oil.ISOVG46 oil "Oil";
  Volume volume(V = 1e-3);
  FlowSource source(q = 1e-5);
equation
  connect(source.port, volume.port);
  annotation(experiment(StartTime = 0, StopTime = 4, Interval = 0.008, Tolerance = 1e-6));
end VolumeExample;
