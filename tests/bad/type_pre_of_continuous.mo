//! E210 at 4: "`pre(x)` outside a `when`"
model M
  Real x(start = 1, fixed = true);
  Real y = pre(x);
equation
  der(x) = -x;
end M;
