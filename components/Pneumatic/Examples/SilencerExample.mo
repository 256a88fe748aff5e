within Pneumatic.Examples;
model SilencerExample "A vessel is let out through a silencer"
  inner Gas gas "Air";
  Volume vessel(V = 2e-3, p_start = 7e5);
  Silencer silencer(C = 1e-8);
equation
  connect(vessel.port, silencer.port);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end SilencerExample;
