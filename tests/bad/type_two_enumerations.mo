//! E210 at 6: "`y` is an enumeration `M.B` and cannot take an enumeration `M.A`"
model M
  type A = enumeration(a, b);
  type B = enumeration(c, d);
  A x = A.a;
  B y = x;
end M;
