//! run
//! W510: "hold one load together"
model M
  Mechanical.Rotational.BearingFriction left, right;
  Mechanical.Rotational.Inertia shaft(J = 1);
equation
  connect(left.flange_b, shaft.flange_a);
  connect(shaft.flange_b, right.flange_a);
end M;
