//! run
//! E401 at 5: "the other start values and the constraints make it 5"
model M
  Mechanical.Rotational.Inertia a(w(start = 10));
  Mechanical.Rotational.Inertia b(w(start = 3));
  Mechanical.Rotational.IdealGear gear(ratio = 2);
equation
  connect(a.flange_b, gear.flange_a);
  connect(gear.flange_b, b.flange_a);
end M;
