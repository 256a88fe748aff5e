//! E210 at 7: "no derivative"
model M
  Integer n;
  Real x;
equation
  n = integer(time);
  x = der(n);
end M;
