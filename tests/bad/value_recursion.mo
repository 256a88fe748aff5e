//! E218 at 6: "`endless`"
function endless
  input Integer n;
  output Integer y;
algorithm
  y := endless(n + 1);
end endless;
model M
  parameter Integer n = endless(1);
  Real x[n] = fill(time, n);
end M;
