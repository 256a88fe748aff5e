//! E212 at 4: "`start` of `x` must be known before the run"
model M
  Real y = time;
  Real x(start = y, fixed = true);
equation
  der(x) = -x;
end M;
