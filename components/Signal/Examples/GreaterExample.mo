within Signal.Examples;
model GreaterExample "A ramp overtakes a sine"
  Ramp ramp(height = 2, offset = -1, duration = 1);
  Sine sine(f = 2);
  Greater greater;
equation
  connect(ramp.y, greater.u1);
  connect(sine.y, greater.u2);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end GreaterExample;
