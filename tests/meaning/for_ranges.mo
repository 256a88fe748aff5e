//! a[1](0.17) = 0.17
//! a[1](0.63) = 0.63
//! a[3](0.17) = 0.51
//! a[3](0.63) = 1.89
//! a[5](0.17) = 0.85
//! a[5](0.63) = 3.15
//! b[2](0.89) = -2
//! c[1,2](0.89) = 12
//! c[3,1](0.89) = 31
//! d(0.89) = 1.25
//! e[2](0.89) = 4
//! f[4](0.89) = 1
//! g(0.89) = 16
//! h[1](0.89) = 10
//! h[3](0.89) = 6
//! m[2,2](0.17) = 0.85
//! m[2,2](0.63) = 3.15
//! n(0.89) = 6
//! o(0.89) = 40
model M "ranges, nested comprehension, end arithmetic"
  Real a[5];
  Integer b[3] = {-i for i in 1:3};
  Integer c[3, 2] = {{10*i + j for j in 1:2} for i in 1:3};
  Real d = 0.25*sum(x for x in 0:0.5:2);
  Real e[3] = {i^2 for i in 1:3};
  Integer f[4] = 4:-1:1;
  Integer g = sum(1:2:7);
  Integer h[3] = 10:-2:6;
  Real m[2, 2] = [time, 2*time; 3*time, 5*time];
  Integer n = sum(size({{1, 2, 3}, {4, 5, 6}})) + 1;
  Integer o = sum(c[end - 1, :]) - 23 + 1 + 20 - 1;
equation
  for i in 1:2:5 loop
    a[i] = i*time;
  end for;
  for i in {2, 4} loop
    a[i] = -i*time;
  end for;
end M;
