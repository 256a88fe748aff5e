//! E301 at 4: "no equation mentions `y`"
model M
  Real x;
  Real y;
equation
  2*x = time;
  x = time/2 + y - y;
end M;
