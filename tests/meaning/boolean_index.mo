//! u(0.2) = 7
//! u(0.8) = 8
//! v(0.2) = 7
//! c[2](0.2) = 1
model M "Boolean as the index of an array"
  constant Real w[Boolean] = {7, 8};
  Boolean late = time > 0.5;
  Real u = w[late];
  Real v = w[false];
  Real c[Boolean] = {0, 1};
end M;
