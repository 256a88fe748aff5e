//! run
//! E506 at 4: "no consistent values of `a` at the event at time 0.5 s"
model M
  Boolean a(start = false, fixed = true);
  Boolean b(start = false, fixed = true);
equation
  a = time > 0.5 and not pre(b);
  b = a;
end M;
