//! E201 at 6: "`Valve` has 4 equations but needs 3"
connector Port
  Real p(unit = "Pa");
  flow Real q(unit = "m3/s");
end Port;
model Valve
  Port a;
  Port b;
  parameter Real G = 1e-9;
  Real q;
equation
  a.q = q;
  b.q = -q;
  a.q + b.q = 0;
  q = G*(a.p - b.p);
end Valve;
model Source
  Port port;
  parameter Real p = 1e5;
equation
  port.p = p;
end Source;
model M
  Source high(p = 2e5);
  Valve valve;
  Source low;
equation
  connect(high.port, valve.a);
  connect(valve.b, low.port);
end M;
