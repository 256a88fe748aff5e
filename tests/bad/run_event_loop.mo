//! run
//! E506 at 8: "b"
model M
  Boolean a(start = false, fixed = true);
  Boolean b(start = false, fixed = true);
equation
  a = time > 0.5 and not pre(b);
  b = a;
end M;
