//! run
//! E403: "share its load in no unique way"
model M
  Mechanical.Rotational.BearingFriction left, right;
  Mechanical.Rotational.Inertia shaft(J = 1);
equation
  connect(left.flange_b, shaft.flange_a);
  connect(shaft.flange_b, right.flange_a);
end M;
