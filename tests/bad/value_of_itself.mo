//! E214 at 3: "`n` depends on itself"
model M
  parameter Integer n = n + 1;
  Real x[n] = fill(time, n);
end M;
