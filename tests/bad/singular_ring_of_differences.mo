//! E301 at 6: "a - b"
model M
  Real a, b, c, x(start = 1, fixed = true);
equation
  der(x) = -x + a - b;
  a - b = x;
  b - c = x;
  c - a = -2*x;
end M;
