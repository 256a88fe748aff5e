//! run
//! E506: "has no mass"
model M
  Mechanical.Translational.Position drive;
  Mechanical.Translational.Spring spring(c = 1e4);
  Mechanical.Translational.SupportFriction friction(f_c = 10);
equation
  drive.s_ref = 5e-3*sin(6*time);
  connect(drive.flange, spring.flange_a);
  connect(spring.flange_b, friction.flange_a);
end M;
