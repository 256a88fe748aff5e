//! E210 at 7: "`pre`"
model M
  Real x(start = 1, fixed = true);
  Real y;
equation
  der(x) = -x;
  y = pre(x);
end M;
