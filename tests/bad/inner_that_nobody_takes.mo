//! E016 at 3: "no component takes `oil`: `oil` is not `inner`"
model M
  Oil.Water oil;
  Hydraulic.Volume volume;
  Hydraulic.Plug plug;
equation
  connect(volume.port, plug.port);
end M;
