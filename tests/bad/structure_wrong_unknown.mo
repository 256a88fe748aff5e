//! E303 at 6: "`x` is determined"
model M
  Real x;
  Real y;
equation
  x = time;
  x^2 = 4;
end M;
