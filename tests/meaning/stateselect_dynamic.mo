//! stop 10
//! tolerance 1e-4
//! L(8.9) = 1
//! E(8.9) = 11.81
model M "rotating pendulum through all quadrants"
  Real x(start = 0, fixed = true), y(start = 1), vx(start = 2, fixed = true), vy, lam;
  Real L = x^2 + y^2;
  Real E = (vx^2 + vy^2)/2 + 9.81*y;
equation
  der(x) = vx;
  der(y) = vy;
  der(vx) = -lam*x;
  der(vy) = -lam*y - 9.81;
  x^2 + y^2 = 1;
end M;
