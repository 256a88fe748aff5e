//! E211 at 3: "an array of 3 elements"
model M
  parameter Real k[3] = {1, 2};
end M;
