//! x(0) = 1
//! y(0) = 3
//! dy(0) = 0
//! a(0) = 0
//! v(0) = -1
model M "Initial equations with derivatives of variables that are no states"
  Real x, y, z, dy = 2*(x + 1)*der(x);
  Real p(start = 1, fixed = true), v, a, f;
initial equation
  der(y) = 0;
  der(a) = 0;
equation
  der(x) = 1 - x + z;
  y = x^2 + 2*x;
  z = sin(time);
  der(p) = v;
  der(v) = a;
  a = f - v;
  f = -p + sin(time)*v;
end M;
