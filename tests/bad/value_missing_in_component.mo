//! E213 at 3: "area"
model Cylinder
  parameter Real area(unit = "m2");
  Real f = 1e5*area;
end Cylinder;
model M
  Cylinder cylinder;
end M;
