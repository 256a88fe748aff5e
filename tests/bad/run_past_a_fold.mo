//! run
//! W511: "jumps from -0.57"
// A toggle without mass: its two solutions of negative x meet at a force of 2/sqrt(27), where it snaps through.
model M
  Real force = 2*time - 1;
  Real x(start = -1);
equation
  0 = force - (x^3 - x);
end M;
