//! E011 at 7: "there is no `volum` here"
model M
  Hydraulic.Volume volume;
  Hydraulic.Plug plug;
  inner Oil.Fluid oil;
equation
  connect(volum.port, plug.port);
end M;
