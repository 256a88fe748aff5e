//! E211 at 5: "x"
model M
  Real x[3];
equation
  x = time;
end M;
