within Hydraulic.Examples;
model SpoolFirstOrderExample "Motion of a spool"
  inner Oil.ISOVG46 oil "Oil";
  Spool.FirstOrder spool;
  Signal.Sine command(amplitude = 0.8, f = 5);
equation
  connect(command.y, spool.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end SpoolFirstOrderExample;
