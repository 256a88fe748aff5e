//! E210 at 5: "Boolean"
model M
  Real x;
equation
  x = time > 1;
end M;
