//! E201 at 10: "`m` is not determined here"
model M
  Real x(start=1, fixed=true);
  discrete Real n(start=0, fixed=true), m(start=0, fixed=true);
equation
  der(x) = -x;
  when time > 0.5 then
    n = 1;
    m = 2;
  elsewhen time > 1 then
    n = 3;
  end when;
end M;
