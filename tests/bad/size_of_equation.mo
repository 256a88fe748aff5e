//! E211 at 5: "3"
model M
  Real x[3];
equation
  x = {time, 2*time};
end M;
