//! s[2](0.5) = -1
//! n(0) = 3
//! b[2](0) = 1
//! w[3](0.5) = 3
model M
  Real u[:] = {time, 2*time, 3};
  Real s[size(u, 1)] = {u[1], -2*time, u[3]};
  parameter Integer n = size(u, 1);
  Boolean a[:] = {true, false};
  Boolean b[:] = not a;
  Real w[:] = if size(u, 1) > 2 then u else zeros(3);
end M;
