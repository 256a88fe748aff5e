//! E012 at 23: "has no `connect(s.c, u.c)` to leave out"
connector C
  Real p(unit = "Pa");
  flow Real q(unit = "m3/s");
end C;
model Source
  C c;
equation
  c.p = 1e5;
end Source;
model End
  C c;
equation
  c.q = 0;
end End;
model Base
  Source s;
  End t;
equation
  connect(t.c, s.c);
end Base;
model M
  extends Base(break connect(s.c, u.c));
end M;
