//! E213 at 3: "`n` has no value"
model M
  parameter Integer n;
  Real x[n];
equation
  for i in 1:n loop
    x[i] = i;
  end for;
end M;
