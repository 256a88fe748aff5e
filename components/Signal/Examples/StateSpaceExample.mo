within Signal.Examples;
model StateSpaceExample "A system of two states"
  Step step;
  StateSpace system(A = [0, 1; -4, -1], B = [0; 4], C = [1, 0]);
equation
  connect(step.y, system.u[1]);
  annotation(experiment(StartTime = 0, StopTime = 5, Interval = 0.01, Tolerance = 1e-6));
end StateSpaceExample;
