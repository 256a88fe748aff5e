//! run
//! E503 at 7: "the stroke is over"
model M
  Real x(start = 0, fixed = true);
equation
  der(x) = 1;
  assert(x < 0.5, "the stroke is over: x = " + String(x));
end M;
