//! E216 at 6: "0"
model M
  Real x[3];
equation
  for i in 0:2 loop
    x[i] = i;
  end for;
end M;
