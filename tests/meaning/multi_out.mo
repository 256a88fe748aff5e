//! model P.M
//! s(0.17) = 2.17
//! s(0.63) = 2.63
//! d(0.17) = -1.83
//! d(0.63) = -1.37
//! q(0.17) = 0.085
//! q(0.63) = 0.315
//! only(0.17) = -1.83
//! only(0.63) = -1.37
//! v[2](0.89) = 4
//! m[1,2](0.89) = 2
//! w(0.17) = 2.17
//! w(0.63) = 2.63
package P
  function f
    input Real a;
    input Real b;
    output Real s = a + b;
    output Real d;
    output Real q;
  algorithm
    d := a - b;
    q := a/b;
  end f;
  function g
    input Integer n;
    output Real v[n];
    output Real m[n, n];
  algorithm
    v := {i^2 for i in 1:n};
    m := fill(0, n, n);
    for i in 1:n, j in 1:n loop
      m[i, j] := i*j;
    end for;
  end g;
  model M
    Real s, d, q, only, w;
    Real v[3], m[3, 3];
  equation
    (s, d, q) = f(time, 2);
    (, only) = f(time, 2);
    (v, m) = g(3);
    w = f(time, 2);
  end M;
end P;
