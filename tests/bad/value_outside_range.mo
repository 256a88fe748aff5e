//! E215 at 4: "`orifice.C_d`"
model M
  inner Oil.Fluid oil;
  Hydraulic.Orifice orifice(C_d = 6.5);
  Hydraulic.Tank a(p = 2e5);
  Hydraulic.Tank b;
equation
  connect(a.port, orifice.port_a);
  connect(orifice.port_b, b.port);
end M;
