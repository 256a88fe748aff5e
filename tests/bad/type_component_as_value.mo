//! E210 at 6: "`mass` is a component, not a value"
model M
  Mechanical.Translational.Mass mass;
  Real x;
equation
  x = 2*mass;
end M;
