//! E011 at 8: "`orifice` has no `a`"
model M
  inner Oil.Fluid oil;
  Hydraulic.Volume volume;
  Hydraulic.Orifice orifice;
  Hydraulic.Tank tank;
equation
  connect(volume.port, orifice.a);
  connect(orifice.port_b, tank.port);
end M;
