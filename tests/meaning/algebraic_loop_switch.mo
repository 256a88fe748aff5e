//! x(0.17) = 0.284036007316
//! x(0.63) = -0.297958611904
//! y(0.89) = -1
model M
  Real u = sin(6*time);
  Real x;
  Real y(start = -1);
equation
  x + (if x > 0 then 2*x else x) = u;
  y^2 = 1 + 0*x;
  when time >= 10 then
    assert(false, "never");
  end when;
end M;
