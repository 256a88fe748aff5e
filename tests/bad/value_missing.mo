//! E213 at 3: "`k` has no value"
model M
  parameter Real k;
  Real x;
equation
  x = k*time;
end M;
