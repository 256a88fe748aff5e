//! n(0.5) = 4
//! k(0.5) = 4
//! k2(0.5) = 5
//! c(0.5) = 0
//! q(0.5) = 2
//! y(0.5) = 2.5
model M
  input Integer n = 4;
  output Integer k = n;
  output Integer k2 = n + 1;
  input Boolean b = true;
  output Boolean c = not b;
  input Real r(start = 9) = 2;
  output Real q = r;
  input Real u = 3*time + 1 "varies, so this is its equation";
  output Real y = u;
end M;
