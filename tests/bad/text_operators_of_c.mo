//! E001 at 5: "expected `and`, found `&&`"
//! E001 at 6: "expected `<>`, found `!=`"
//! E001 at 7: "expected `^`, found `**`"
model M
  Boolean a = time > 1 && time < 2;
  Boolean b = time != 1;
  Real x = time**2;
end M;
