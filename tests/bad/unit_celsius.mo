//! W231 at 6: "degC"
model M
  parameter Real T_oil(unit = "degC") = 40;
  Real T(unit = "K");
equation
  T = T_oil;
end M;
