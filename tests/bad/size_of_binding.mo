//! E211 at 3: "an array of at least 3 elements"
model M
  parameter Real k[3] = {1, 2};
end M;
