//! stop 5
//! x(5) = 0
//! v(5) = 0
// the impacts of a ball that comes to rest follow each other faster and faster, and then there are none: nothing is said
model M
  Real x(start = 1, fixed = true), v(start = 0, fixed = true);
  Boolean flying(start = true, fixed = true);
  Boolean impact;
  Real v_new(start = 0, fixed = true);
equation
  impact = x <= 0;
  der(x) = v;
  der(v) = if flying then -9.81 else 0;
  when {x <= 0 and v <= 0, impact} then
    v_new = if edge(impact) then -0.7*pre(v) else 0;
    flying = v_new > 0;
    reinit(v, v_new);
  end when;
end M;
