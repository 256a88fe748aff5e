//! E021 at 12: "`k`"
function scale
  input Real u;
  input Real k;
  output Real y;
algorithm
  y := k*u;
end scale;
model M
  Real x;
equation
  x = scale(time);
end M;
