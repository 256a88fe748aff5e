//! E217 at 4: "`k`"
model M
  parameter Real a = -1;
  parameter Real k = sqrt(a);
  Real x = k;
end M;
