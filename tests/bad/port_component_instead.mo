//! E105 at 6: "only ports can be connected"
model M
  Mechanical.Translational.Mass mass;
  Mechanical.Translational.Spring spring;
equation
  connect(mass, spring);
end M;
