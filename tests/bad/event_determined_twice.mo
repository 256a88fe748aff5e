//! E303 at 10: "`n` is determined twice"
model M
  Real x(start=1, fixed=true);
  discrete Real n(start=0, fixed=true), m(start=0, fixed=true);
equation
  der(x) = -x;
  when time > 0.5 then
    n = 1;
    m = 1;
    n = 2;
  end when;
end M;
