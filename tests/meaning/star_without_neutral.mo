//! i0(0) = 0
//! i0(1) = 0
//! star(1) = 0
//! i[1](1) = 0.632120558829
model M "Sums that cancel: the zero sequence of a star is no state"
  constant Integer m = 3;
  parameter Real L0 = 0.5;
  Real i[m](start = {0, 0, 0}), i0, v0, v[m] = {1.1, -0.4, -0.4}, star;
equation
  sum(i) = 0;
  m*i0 = sum(i);
  star = L0*der(i0);
  for k in 1:m loop
    der(i[k]) + i[k] = v[k] - star - v0;
  end for;
end M;
