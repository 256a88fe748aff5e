//! E211 at 7: "indexes arrays of 3 and of 4 elements"
//! E216 at 6: "how often the loop"
model M
  Real x[3], y[4];
algorithm
  for i loop
    x[i] := y[i];
  end for;
equation
  y = {1, 2, 3, 4};
end M;
