//! E012 at 3: "`strat` is not an attribute of `Real`"
model M
  Real x(strat = 1, fixed = true);
equation
  der(x) = -x;
end M;
