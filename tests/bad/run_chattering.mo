//! run
//! E502 at 6: "x"
model M
  Real x(start = 0.5, fixed = true);
equation
  der(x) = if x > 0 then -1 else 1;
end M;
