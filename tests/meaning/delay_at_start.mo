//! x(0) = 3
//! y(0) = 3
//! y(0.5) = 3
//! s(1) = 0.564642473395035
// At the start a delayed value is the value itself, and may be what determines it.
model M
  Real x, y, s;
initial equation
  x + y = 6;
equation
  der(x) = 1;
  y = delay(x, 0.5);
  s = delay(sin(delay(time, 0.1)), 0.3);
end M;
