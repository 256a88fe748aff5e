//! cylinder.s(0) = 0.1
//! load.s(0) = 0.1
//! second.s(0) = 0.3
//! behind.s(0) = 0.3
//! a.w(0) = 10
//! b.w(0) = 5
//! volume.p(0) = 1e6
//! accumulator.p(0) = 1e6
//! filled.p(0) = 5e5
//! empty.p(0) = 5e5
//! body.s(0) = 0.2
//! x(0) = 4
model M "What is joined rigidly starts as the circuit says of one of them, and nothing has to be freed"
  inner Oil.ISOVG46 oil;
  Hydraulic.Cylinder cylinder(s_start = 0.1);
  Mechanical.Translational.Mass load(m = 1000);
  Hydraulic.Tank tank;
  Hydraulic.Orifice way_a, way_b;
  // the model's own values count more than those of the parts of a component
  Hydraulic.Cylinder behind(stroke = 0.5);
  Mechanical.Translational.Mass second(m = 1000, s(start = 0.3));
  Hydraulic.Orifice way_c, way_d;
  Mechanical.Rotational.Inertia a(w(start = 10)), b;
  Mechanical.Rotational.IdealGear gear(ratio = 2);
  Hydraulic.Volume volume(p_start = 1e6);
  Hydraulic.Accumulator accumulator;
  // freed: the other one's class says it
  Hydraulic.Volume filled(p_start = 9e5, p(fixed = false));
  Hydraulic.Accumulator empty;
  Mechanical.Translational.Mass body(m = 1, s(start = 0.2));
  Mechanical.Translational.Spring spring(c = 100);
  Mechanical.Translational.Fixed wall;
  // an initial equation counts more than a start that is not fixed
  Real x(start = 1);
initial equation
  x = 4;
equation
  connect(cylinder.flange, load.flange_a);
  connect(tank.port, way_a.port_a);
  connect(way_a.port_b, cylinder.port_1);
  connect(tank.port, way_b.port_a);
  connect(way_b.port_b, cylinder.port_2);
  connect(behind.flange, second.flange_a);
  connect(tank.port, way_c.port_a);
  connect(way_c.port_b, behind.port_1);
  connect(tank.port, way_d.port_a);
  connect(way_d.port_b, behind.port_2);
  connect(a.flange_b, gear.flange_a);
  connect(gear.flange_b, b.flange_a);
  connect(volume.port, accumulator.port);
  connect(filled.port, empty.port);
  connect(body.flange_b, spring.flange_a);
  connect(spring.flange_b, wall.flange);
  der(x) = -x;
end M;
