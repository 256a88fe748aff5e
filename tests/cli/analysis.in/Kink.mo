model Kink "The rate jumps at a threshold without an event"
  parameter Real p = 1, k = 2, q = 3, c = 1;
  Real x(start = 0, fixed = true), y(start = q, fixed = true);
equation
  der(x) = noEvent(if x < p then 1 else 3);
  der(y) = c - k*y + 0.01*x;
  annotation(experiment(StopTime = 2));
end Kink;
