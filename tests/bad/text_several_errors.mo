//! E001 at 7: "expected `;` after `z`"
//! E001 at 9: "expected an expression, found `;`"
//! E001 at 10: "expected `=`, found `:=`"
model M
  Real x;
  Real y;
  Real z
equation
  x = 1 +;
  y := 2;
end M;
