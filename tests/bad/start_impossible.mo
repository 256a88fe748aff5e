//! run
//! E403 at 6: "x"
model M
  Real x(start = 1);
equation
  x^2 = -1 - time;
end M;
