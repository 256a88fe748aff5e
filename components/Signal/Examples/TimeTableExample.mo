within Signal.Examples;
model TimeTableExample "The signal, integrated"
  TimeTable source(table = [0, 0; 0.2, 1; 0.4, 1; 0.4, -1; 1, 0]);
  Integrator integral;
equation
  connect(source.y, integral.u);
  annotation(experiment(StartTime = 0, StopTime = 1, Interval = 0.002, Tolerance = 1e-6));
end TimeTableExample;
