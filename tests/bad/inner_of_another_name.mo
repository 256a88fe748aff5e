//! E016 at 3: "they look for `inner oil`"
model M
  inner Oil.Water water;
  Hydraulic.Volume volume;
  Hydraulic.Plug plug;
equation
  connect(volume.port, plug.port);
end M;
