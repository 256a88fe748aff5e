//! stop 3
//! on0(3) = 1
//! x(0.03) = 1.97
//! step(0) = 1
//! step(1.5) = 0
// pre of a variable follows from an initial equation: by a value found at the start, and through the equation a = pre(b)
model M
  Real x(start = 2, fixed = true);
  Real limit;
  Boolean on;
  Boolean on0(start = false, fixed = true);
  Boolean step, next;
initial equation
  pre(on) = x > limit;
  pre(next) = pre(step);
  step = true;
equation
  limit = 1.5;
  der(x) = if on then -1 else 1;
  on = x > 2.5 or pre(on) and x > 1;
  on0 = time > 0.01 or pre(on0);
  step = pre(next);
  next = step and time < 1;
end M;
