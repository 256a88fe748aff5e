//! W232 at 3: "barr"
model M
  parameter Real p(unit = "barr") = 5;
  Real x = p;
end M;
