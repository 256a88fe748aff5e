//! E211 at 5: "size [3] on the left"
model M
  Real x[3];
equation
  x = time;
end M;
