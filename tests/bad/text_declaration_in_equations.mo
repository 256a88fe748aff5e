//! E001 at 6: "a declaration stands before"
model M
  Real x;
equation
  x = 1;
  parameter Real k = 2;
end M;
