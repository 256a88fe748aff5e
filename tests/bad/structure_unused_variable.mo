//! E303 at 6: "`x` is determined more than once"
model M
  Real x;
  Real y;
equation
  x = time;
  x = 2*time;
end M;
