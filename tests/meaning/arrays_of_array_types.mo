//! last(1) = 24
//! n(0) = 2
//! m(0) = 3
// the dimensions of a type come before those of the type that it is made of
model M
  type Triple = Real[3];
  type Pairs = Triple[2];
  Pairs a;
  Real last = a[2, 3];
  parameter Integer n = size(a, 1);
  parameter Integer m = size(a, 2);
equation
  for i in 1:2 loop
    for j in 1:3 loop
      a[i, j] = 10*i + j + time;
    end for;
  end for;
end M;
