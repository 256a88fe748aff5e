//! E019 at 4: "`unit` is final"
model M
  type Angle = Real(final unit = "rad");
  Angle a(unit = "deg") = 1;
end M;
