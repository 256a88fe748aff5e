//! stop 3
//! tolerance 2e-6
//! x(0.6) = 0.4
//! x(1.5) = -0.375
//! x(2.01) = -0.499950166666667
//! x(2.49) = -0.399558166666667
//! x(3) = -0.166666666666667
//! rate(2.49) = 0.36995
// By the method of steps: 1 - t, + (t - 1)^2/2 from 1 on, - (t - 2)^3/6 from 2 on.
model M
  parameter Real T = 1;
  Real x(start = 1, fixed = true), rate;
equation
  der(x) = -delay(x, T);
  rate = der(x);
  annotation(experiment(Tolerance = 1e-8));
end M;
