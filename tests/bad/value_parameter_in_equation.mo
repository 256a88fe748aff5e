//! E201 at 2: "this equation holds no unknown"
model M
  parameter Real k = 2;
  Real x;
equation
  x = time;
  k = 3;
end M;
