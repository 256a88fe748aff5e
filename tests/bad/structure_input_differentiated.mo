//! E304: "the derivative of the input `s_ref` is needed"
model M
  input Real s_ref;
  Mechanical.Translational.Mass mass;
equation
  mass.a = s_ref*mass.flange_b.s;
  mass.s = s_ref;
end M;
