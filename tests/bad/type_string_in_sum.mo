//! E210 at 6: "String"
model M
  parameter String name = "pump";
  Real x;
equation
  x = name + 1;
end M;
