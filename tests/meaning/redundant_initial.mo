//! x(0) = 2
//! y(0) = 4
//! x(1) = 0.735758882343
model M
  Real x(start = 1), y;
initial equation
  y = 4;
  x = 2;
  der(x) = -2;
equation
  der(x) = -x;
  y = 2*x;
end M;
