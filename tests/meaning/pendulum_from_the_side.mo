//! x(0) = 1
//! y(0) = 0
//! energy(1) = 0
//! radius(1) = 1
// Started where the constraint does not determine y to first order: x^2 + y^2 = 1 at x = 1.
model M
  Real x(start = 1, fixed = true), y(start = 0), vx, vy(start = 0, fixed = true), l;
  Real energy = (vx^2 + vy^2)/2 + 9.81*y;
  Real radius = sqrt(x^2 + y^2);
equation
  der(x) = vx;
  der(y) = vy;
  der(vx) = -l*x;
  der(vy) = -l*y - 9.81;
  x^2 + y^2 = 1;
end M;
