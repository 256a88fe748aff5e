//! E211 at 7: "3"
model M
  Real a[3] = {1, 2, 3};
  Real b[2] = {1, 2};
  Real c[3];
equation
  c = a + b;
end M;
