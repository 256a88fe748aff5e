//! E303 at 7: "holds no unknown"
model M
  parameter Real k = 2;
  Real x;
equation
  x = time;
  k = 3;
end M;
