within Signal.Examples;
model ClockExample "The signal, integrated"
  Clock source;
  Integrator integral;
equation
  connect(source.y, integral.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end ClockExample;
