//! E214 at 3: "cyclically"
model M
  parameter Real a = 2*b;
  parameter Real b = a + 1;
  Real x = a;
end M;
