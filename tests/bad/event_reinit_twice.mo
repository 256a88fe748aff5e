//! E303 at 13: "`x` gets a new value twice"
model M
  Real x(start=1, fixed=true);
  discrete Real n(start=0, fixed=true), m(start=0, fixed=true);
equation
  der(x) = -x;
  when time > 0.5 then
    n = 1;
    m = 1;
    if x > 0.7 then
      reinit(x, 2);
    end if;
    reinit(x, 3);
  end when;
end M;
