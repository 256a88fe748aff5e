//! E020 at 5: "`pow`"
model M
  Real x;
equation
  x = pow(time, 2);
end M;
