//! E303 at 6: "`y`"
model M
  Real x;
  Real y;
equation
  2*x = time;
  x^2 + 1 = time^2;
end M;
