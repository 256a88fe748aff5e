//! stop 2
//! n(0.6) = 1
//! x(0.6) = 2.7145122541078788
//! n(2) = 2
//! m(2) = 0
model M
  parameter Boolean b = false;
  Real x(start = 1, fixed = true);
  discrete Real n(start = 0, fixed = true), m(start = 0, fixed = true);
equation
  der(x) = -x;
  when time >= 0.5 then
    n = 1;
    m = if b then 1 else pre(m);
    if b then
      reinit(x, 5);
    end if;
    if x > 0.5 then
      reinit(x, 3);
    else
      reinit(x, 4);
    end if;
  elsewhen time > 1 then
    n = 2;
    m = pre(m);
  end when;
end M;
