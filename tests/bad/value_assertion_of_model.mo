//! E503 at 6: "b must lie above a: a = 2"
model M
  parameter Real a = 2;
  parameter Real b = a - 1;
equation
  assert(b > a, "b must lie above a: a = " + String(a));
end M;
