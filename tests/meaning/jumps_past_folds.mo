//! x(0) = -1.324717957244746
//! x(0.5) = -1
//! x(1) = 1.324717957244746
//! u(1) = 0.178110047
//! y(1) = 0.999670132
// Loops whose solution ends: a toggle without mass snaps through, a comparator with positive feedback switches over.
model M
  Real force = 2*time - 1;
  Real x(start = -1);
  Real u(start = 0, fixed = true), y(start = -1);
equation
  0 = force - (x^3 - x);
  der(u) = -2*y - 0.2*u;
  y = tanh(4*(y + 0.5*u));
end M;
