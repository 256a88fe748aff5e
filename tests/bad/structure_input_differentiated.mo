//! E304: "the derivative of the input `s_ref` is needed"
model M
  input Real s_ref;
  Mechanical.Translational.Position drive(s_ref = s_ref);
  Mechanical.Translational.Mass mass(s(fixed = false), v(fixed = false));
equation
  connect(drive.flange, mass.flange_a);
end M;
