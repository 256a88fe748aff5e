//! E217 at 4: "`k`"
model M
  parameter Real a = 0;
  parameter Real k = 1/a;
  Real x = k;
end M;
