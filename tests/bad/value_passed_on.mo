//! E215 at 5: "`unit.V` is -0.000001 m3, less than its `min`"
// The pump within gets the same value: what follows from one mistake is told once.
model M
  inner Oil.Fluid oil;
  Hydraulic.ChargeUnit unit(V = -1e-6);
  Hydraulic.Tank tank;
  Hydraulic.Plug a;
  Hydraulic.Plug b;
  Mechanical.Rotational.ConstantSpeed shaft(w_fixed = 100);
equation
  connect(unit.port_a, a.port);
  connect(unit.port_b, b.port);
  connect(unit.port_tank, tank.port);
  connect(shaft.flange, unit.flange);
end M;
