//! E303 at 6: "`x` is determined 2 times"
model M
  Real x;
  Real y;
equation
  x = time;
  x = 2*time;
end M;
