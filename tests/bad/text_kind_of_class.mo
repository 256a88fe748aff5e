//! E001 at 2: "expected a class"
modell M
  Real x;
equation
  x = 1;
end M;
