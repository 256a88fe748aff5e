//! E215 at 4: "less than its `min`"
model M
  inner Oil.Fluid oil;
  Hydraulic.Volume volume(V = 1e-3, beta_wall = 0);
  Hydraulic.Plug plug;
equation
  connect(volume.port, plug.port);
end M;
