//! E211 at 9: "and these differ in size: [2] for `u`, [3] for `k`"
model M
  function f
    input Real u;
    input Real k;
    output Real y = k*u;
  algorithm
  end f;
  Real y[2] = f({1, 2}, {1, 2, 3});
end M;
