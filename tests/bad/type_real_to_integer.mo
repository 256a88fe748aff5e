//! E210 at 3: "`div(a, b)` divides whole numbers"
model M
  Integer n = 3/2;
end M;
