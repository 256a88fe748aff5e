within Signal.Examples;
model TrapezoidExample "The signal, integrated"
  Trapezoid source(holding = 0.3);
  Integrator integral;
equation
  connect(source.y, integral.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end TrapezoidExample;
