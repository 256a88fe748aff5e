//! E021 at 6: "`zeros` has no argument `foo`"
//! E021 at 7: "`fill` takes 2 arguments or more, not 1"
//! E021 at 8: "`initial` takes no argument, not 1"
//! E021 at 9: "`homotopy` has no argument `simple`"
model M
  Real x[2] = zeros(2, foo = 3);
  Real y = fill(time);
  Boolean b = initial(1);
  Real z = homotopy(time, simplified = 2*time, simple = 1);
end M;
