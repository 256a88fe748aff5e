//! E210 at 3: "`x` is `discrete` and gets its value outside `when`"
model M
  discrete Real x = 1;
  Real y = x*time;
end M;
