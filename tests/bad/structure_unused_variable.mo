//! E301 at 4: "no equation mentions `y`"
model M
  Real x;
  Real y;
equation
  x = time;
  x = 2*time;
end M;
