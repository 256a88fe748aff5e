//! x(1) = 6
//! z(1) = -6
//! p_x(1) = 6
model M "The guess of a parameter that is found at the start is one for what equals it"
  parameter Real p(start = 5, fixed = false);
  parameter Real n(start = 5, fixed = false);
  Real x, y, z;
  Real p_x = 0.5*(p + n);
initial equation
  (x - 1)*(x - 6) = 0;
  (z + 1)*(z + 6) = 0;
equation
  x = y;
  y = p;
  z = -n;
end M;
