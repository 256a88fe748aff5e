//! E001 at 6: "expected `then`, found `=`"
model M
  parameter Integer n = 1;
  Real x;
equation
  x = if n = 1 then 1 else 2;
end M;
