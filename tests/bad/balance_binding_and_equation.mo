//! E201 at 2: "`M` has 2 equations but needs 1"
model M
  Real x = 1;
equation
  x = time;
end M;
