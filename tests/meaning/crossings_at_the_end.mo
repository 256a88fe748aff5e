//! n(0.99) = 0
//! n(1) = 1
//! hits(1) = 1
//! v(1) = 0.5
//! above(1) = 0
//! on(1) = 1
model M "What crosses exactly at the stop time has crossed, what only comes near has not"
  Real x(start = 0, fixed = true) "reaches 1 at 1";
  Integer n(start = 0, fixed = true);
  Real h(start = 0.5, fixed = true) "falls to 0 at 1 with speed 1";
  Real v(start = 0, fixed = true);
  Integer hits(start = 0, fixed = true);
  Real z(start = 0, fixed = true) "comes within 2e-9 of 1 and stays below";
  Integer above(start = 0, fixed = true);
  Real on = if x < 1 then 0 else 1;
equation
  der(x) = 1;
  der(h) = v;
  der(v) = -1;
  der(z) = 20*(1 - z);
  when x >= 1 then
    n = pre(n) + 1;
  end when;
  when h < 0 then
    reinit(v, -0.5*pre(v));
    hits = pre(hits) + 1;
  end when;
  when z > 1 then
    above = pre(above) + 1;
  end when;
end M;
