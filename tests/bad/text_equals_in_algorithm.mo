//! E001 at 5: "expected `:=`, found `=`"
model M
  Real x;
algorithm
  x = 1;
end M;
