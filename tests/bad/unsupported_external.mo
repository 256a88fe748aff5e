//! model M
//! E017 at 9: "the external function `f`"
function f
  input Real u;
  output Real y;
  external "C" y = compute(u);
end f;
model M
  Real x = f(time);
end M;
