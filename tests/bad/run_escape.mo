//! run
//! E501 at 6: "x"
model M
  Real x(start = 2, fixed = true);
equation
  der(x) = x^2;
end M;
