within Signal.Examples;
model RampExample "The signal, integrated"
  Ramp source(duration = 0.5, startTime = 0.2);
  Integrator integral;
equation
  connect(source.y, integral.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end RampExample;
