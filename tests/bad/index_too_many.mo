//! E216 at 6: "x"
model M
  Real x[3] = {1, 2, 3};
  Real y;
equation
  y = x[1, 2];
end M;
