//! E105 at 6: "only ports can be connected"
model M
  Mechanical.Translational.Mass mass;
  Mechanical.Translational.Fixed wall;
equation
  connect(mass.s, wall.s0);
end M;
