//! E302 at 15: "nothing fixes the pressure level of {upper"
connector Port
  Real p(unit = "Pa");
  flow Real q(unit = "m3/s");
end Port;
model Resistance
  Port a;
  Port b;
  parameter Real G(unit = "m3/(s.Pa)") = 1e-12;
equation
  a.q + b.q = 0;
  a.q = G*(a.p - b.p);
end Resistance;
model M
  Resistance upper;
  Resistance lower;
equation
  connect(upper.b, lower.a);
  connect(lower.b, upper.a);
end M;
