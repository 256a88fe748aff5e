//! run
//! W505 at 7: "linear range"
model M
  Real x(start = 0, fixed = true);
equation
  der(x) = 1;
  assert(x < 0.5, "the spring leaves its linear range", AssertionLevel.warning);
end M;
