//! model M
//! E017 at 6: "external"
function f
  input Real u;
  output Real y;
  external "C" y = compute(u);
end f;
model M
  Real x = f(time);
end M;
