//! i(1) = 2
//! j(1) = 0.864664716763
model M
  parameter Real L = 0, R = 1;
  parameter Boolean quick = true;
  Real i(start = 5), j(start = 0, fixed = true), k(start = 7);
equation
  2 = R*i + L*der(i);
  1 = j + der(j)/2;
  k - 1 = if quick then 0 else L*der(k);
end M;
