//! E211 at 4: "each"
model M
  parameter Real k = 2;
  Mechanical.Translational.Mass mass[2](m = k);
end M;
