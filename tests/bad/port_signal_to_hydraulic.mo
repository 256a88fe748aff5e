//! E104 at 7: "cannot be joined"
model M
  inner Oil.Fluid oil;
  Hydraulic.Volume volume;
  Signal.Constant pressure(k = 1e5);
equation
  connect(pressure.y, volume.port);
end M;
