//! E401 at 4: "as by `load(s(fixed = false))`"
model M
  Hydraulic.Cylinder cylinder(s_start = 0.1);
  Mechanical.Translational.Mass load(m = 1000, s(start = 0.3));
  Hydraulic.Tank a, b;
  inner Oil.ISOVG46 oil;
  Hydraulic.Orifice way_a, way_b;
equation
  connect(cylinder.flange, load.flange_a);
  connect(a.port, way_a.port_a);
  connect(way_a.port_b, cylinder.port_1);
  connect(b.port, way_b.port_a);
  connect(way_b.port_b, cylinder.port_2);
end M;
