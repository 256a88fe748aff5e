//! E304: "the derivative of the input `s_ref` is needed"
model M
  input Real s_ref;
  Mechanical.Translational.Mass mass;
equation
  mass.flange_a.f = 0;
  mass.s = s_ref;
end M;
