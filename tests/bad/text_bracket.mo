//! E002 at 5: "`(` is not closed"
model M
  Real x;
equation
  x = 2*(1 + time;
end M;
