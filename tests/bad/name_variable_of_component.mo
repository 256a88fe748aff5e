//! E011 at 6: "`mass` has no `position`"
model M
  Mechanical.Translational.Mass mass;
  Real x;
equation
  x = mass.position;
end M;
