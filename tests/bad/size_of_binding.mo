//! E211 at 3: "`k`"
model M
  parameter Real k[3] = {1, 2};
end M;
