//! E301 at 8: "its unknowns cancel"
model M
  Real x;
  Real y;
  Real z;
equation
  der(x) = sin(y);
  x - (x + 1) = floor(time) - 2;
  x = cos(z);
end M;
