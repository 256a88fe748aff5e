//! E013 at 5: "`k` is declared twice"
model M
  parameter Real k = 1;
  Real x;
  Real k;
equation
  x = k;
end M;
