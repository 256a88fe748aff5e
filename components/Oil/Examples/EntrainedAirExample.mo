within Oil.Examples;
model EntrainedAirExample "Pressure of a volume over the oil pumped into it"
  inner Oil.Fluid oil "Oil";
  Hydraulic.Volume volume(V = 1e-3);
  Hydraulic.FlowSource source(q = 1e-6);
equation
  connect(source.port, volume.port);
  annotation(experiment(StartTime = 0, StopTime = 20, Interval = 0.04, Tolerance = 1e-6));
end EntrainedAirExample;
