//! E104 at 7: "cannot be joined"
model M
  inner Oil.Fluid oil;
  Hydraulic.Volume volume;
  Mechanical.Rotational.Inertia inertia;
equation
  connect(volume.port, inertia.flange_a);
end M;
