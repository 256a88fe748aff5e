//! E303 at 11: "`v` gets a new value from two `when` clauses"
model M
  Real h(start=1, fixed=true), v(start=0, fixed=true);
equation
  der(h) = v;
  der(v) = -9.81;
  when h < 0 then
    reinit(v, -0.7*pre(v));
  end when;
  when h > 2 then
    reinit(v, -pre(v));
  end when;
end M;
