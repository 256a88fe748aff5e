//! run
//! E504 at 8: "is not finite"
model M
  Real x(start = 1, fixed = true);
  Real y;
equation
  der(x) = -1;
  y = 1/(if time < 0.5 then 1 else 0);
end M;
