//! h_mid(0) = 3
//! h_mid(1) = 2
//! carried(1) = -2
// where nothing flows, what a flow carries is between what it may carry; it is determined at any time
model M
  Real m = if time < 0.5 then 0 else 1;
  Real h_mid;
  Real a, b;
  Real carried = b;
equation
  a = semiLinear(m, 2 + 0*time, h_mid);
  b = semiLinear(-m, 4 + 0*time, h_mid);
  a + b = 0;
end M;
