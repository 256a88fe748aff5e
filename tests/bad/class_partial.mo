//! E018 at 4: "is partial and cannot be a component"
model M
  inner Oil.Fluid oil;
  Hydraulic.Bases.TwoPort valve;
end M;
