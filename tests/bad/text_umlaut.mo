//! E001 at 3: "which Modelica does not use"
model M
  Real öl;
equation
  0 = 1;
end M;
