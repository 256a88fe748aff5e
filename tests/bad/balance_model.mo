//! E201 at 2: "`M` has 1 equation but needs 2"
model M
  Real x;
  Real y;
equation
  x + y = time;
end M;
