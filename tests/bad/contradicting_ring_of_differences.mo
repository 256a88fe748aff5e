//! E303 at 5: "a - b"
model M
  Real a, b, c;
equation
  a - b = 1;
  b - c = time;
  c - a = 3;
end M;
