//! E201 at 6: "`Relief` has 2 equations but needs 3"
connector Port
  Real p(unit = "Pa");
  flow Real q(unit = "m3/s");
end Port;
model Relief
  Port a;
  Port b;
  parameter Real G = 1e-9;
  Real q;
equation
  a.q = q;
  q = G*(a.p - b.p);
end Relief;
model Source
  Port port;
  parameter Real p = 1e5;
equation
  port.p = p;
end Source;
model M
  Source high(p = 2e5);
  Relief relief;
  Source low;
equation
  connect(high.port, relief.a);
  connect(relief.b, low.port);
end M;
