//! E104 at 6: "cannot be joined"
model M
  Mechanical.Rotational.Inertia inertia;
  Mechanical.Translational.Mass mass;
equation
  connect(inertia.flange_b, mass.flange_a);
end M;
