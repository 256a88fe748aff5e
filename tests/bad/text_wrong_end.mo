//! E003 at 6: "expected `end Press`"
model Press
  Real x;
equation
  x = 1;
end Pres;
