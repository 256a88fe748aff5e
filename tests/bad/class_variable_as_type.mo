//! E024 at 4: "`k` is a component, not a class"
model M
  parameter Real k = 1;
  k x;
end M;
