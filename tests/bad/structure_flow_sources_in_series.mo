//! E302 at 15: "pressure level"
connector Port
  Real p(unit = "Pa");
  flow Real q(unit = "m3/s");
end Port;
model FlowSource
  Port a;
  Port b;
  parameter Real q(unit = "m3/s") = 1e-4;
equation
  a.q = q;
  b.q = -q;
end FlowSource;
model M
  FlowSource first;
  FlowSource second(q = 2e-4);
equation
  connect(first.b, second.a);
  connect(second.b, first.a);
end M;
