//! E216 at 6: "x"
model M
  Real x = time;
  Real y;
equation
  y = x[1];
end M;
