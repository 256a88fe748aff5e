//! E215 at 3: "`beta_0` of `Oil.Fluid.density` is 0"
model M
  inner Oil.Fluid oil(redeclare function density = Oil.Compression.constantModulus(beta_0 = 0));
  Hydraulic.Orifice orifice(A = 1e-6);
  Hydraulic.PressureSource source(p = 1e6);
  Hydraulic.Volume volume(V = 1e-3);
equation
  connect(source.port, orifice.port_a);
  connect(orifice.port_b, volume.port);
end M;
