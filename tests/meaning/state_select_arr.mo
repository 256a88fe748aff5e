//! x[1](0.17) = 0.843664816596
//! x[1](0.63) = 0.532591801007
//! s(0.17) = 1.55543513936
//! s(0.63) = 0.816245827507
//! d(0.17) = 0.131894493834
//! d(0.63) = 0.248937774507
model M
  Real x[2](stateSelect = {StateSelect.never, StateSelect.avoid});
  Real s(start = 2, fixed = true, stateSelect = StateSelect.always);
  Real d(start = 0, fixed = true, stateSelect = StateSelect.always);
equation
  s = x[1] + x[2];
  d = x[1] - x[2];
  for i in 1:2 loop
    der(x[i]) = -i*x[i];
  end for;
end M;
