//! E024 at 9: "is a function"
function double
  input Real u;
  output Real y;
algorithm
  y := 2*u;
end double;
model M
  double x;
end M;
