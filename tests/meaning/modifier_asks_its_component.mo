//! model M
//! p.y(1) = 8
//! q.y(1) = 10
//! r.deep.y(1) = 14
model P
  parameter Integer n = 3;
  parameter Real a[:] = ones(n);
  Real y = sum(a);
end P;
model R
  P deep(a = fill(2, deep.n));
end R;
model M
  P p(n = 4, a = fill(2, p.n));
  P q(a = {1, 2, 3, 4}, n = size(q.a, 1));
  R r(deep(n = 7));
end M;
