//! E001 at 5: "expected `=`, found `:=`"
model M
  Real x;
equation
  x := 1;
end M;
