//! E401 at 3: "one condition too many"
model M
  Real x(start = 1, fixed = true);
initial equation
  der(x) = 0;
equation
  der(x) = 1 - x;
end M;
