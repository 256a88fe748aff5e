//! E212 at 4: "the parameter `k` is given a value that changes"
model M
  Real x = time;
  parameter Real k = 2*x;
end M;
