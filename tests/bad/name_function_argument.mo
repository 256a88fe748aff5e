//! E021 at 12: "`exponnent`"
function power
  input Real base;
  input Real exponent = 2;
  output Real y;
algorithm
  y := base^exponent;
end power;
model M
  Real x;
equation
  x = power(time, exponnent = 3);
end M;
