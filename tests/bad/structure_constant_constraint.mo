//! E201 at 2: "`M` has 3 equations but needs 2"
model M
  Real x(start = 1);
  Real y(start = 1);
equation
  der(x) = y;
  der(y) = -x;
  x = 3;
end M;
