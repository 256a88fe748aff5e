//! E103 at 4: "port `orifice.port_b` is not connected"
model M
  inner Oil.Fluid oil;
  Hydraulic.Orifice orifice;
  Hydraulic.Volume volume;
equation
  connect(volume.port, orifice.port_a);
end M;
