//! E105 at 10: "two outputs, `a.y` and `b.y`, are joined"
model M
  block G
    input Real u;
    output Real y = 2*u;
  end G;
  G a, b;
equation
  connect(a.u, b.u);
  connect(a.y, b.y);
end M;
