//! E020 at 6: "`k`"
model M
  parameter Real k = 2;
  Real x;
equation
  x = k(time);
end M;
