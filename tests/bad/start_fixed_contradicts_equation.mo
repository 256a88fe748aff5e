//! E401 at 4: "`y`"
model M
  Real x(start = 1, fixed = true);
  Real y(start = 5, fixed = true);
equation
  der(x) = -x;
  y = 2*x;
end M;
