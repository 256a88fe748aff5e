//! E201 at 9: "`m = pre(m)`"
model M
  Real x(start=1, fixed=true);
  discrete Real n(start=0, fixed=true), m(start=0, fixed=true);
equation
  der(x) = -x;
  when time > 0.5 then
    n = 1;
    if x > 0.5 then
      m = 2;
    end if;
  end when;
end M;
