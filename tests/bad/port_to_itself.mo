//! E105 at 6: "`volume.port` is connected to itself"
model M
  inner Oil.Fluid oil;
  Hydraulic.Volume volume;
equation
  connect(volume.port, volume.port);
end M;
