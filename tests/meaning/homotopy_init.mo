//! x(0.17) = 2.53099444979
//! x(0.63) = 1.59777540302
//! y(0.17) = 7.40593290486
//! y(0.63) = 3.5528862385
model M
  parameter Real k(fixed = false, start = 1);
  Real x(start = 10);
  Real y;
initial equation
  x + k = 5;
  homotopy(k^3 + k, 10*k) = 10;
equation
  der(x) = -x;
  y = homotopy(actual = x^2 + 1, simplified = x);
end M;
