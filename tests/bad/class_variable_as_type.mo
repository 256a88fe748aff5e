//! E010 at 4: "`k` is not a class"
model M
  parameter Real k = 1;
  k x;
end M;
