//! run
//! E401 at 6: "`cylinder.p_2_start = 300000`"
model M
  inner Oil.ISOVG46 oil;
  Hydraulic.Tank tank(p = 3e5);
  Hydraulic.Cylinder cylinder(p_2_start = 2e5);
  Hydraulic.Orifice way;
equation
  connect(tank.port, cylinder.port_2);
  connect(tank.port, way.port_a);
  connect(way.port_b, cylinder.port_1);
end M;
