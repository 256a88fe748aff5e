//! E210 at 3: "a single number as divisor"
model M
  Real x[3] = {1, 2, 3}/{1, 2, 4};
end M;
