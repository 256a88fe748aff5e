//! a(1) = 6
//! n(1) = 3
//! s(1) = 12
// a variable of a function takes the size of what is assigned to it; locals may use each other before they are declared
model M
  function f
    input Real x[:];
    output Real y;
    output Integer n;
  protected
    Real all[:];
    Real last = first + 1;
    Real first = x[1];
  algorithm
    all := cat(1, x, {last});
    y := sum(all);
    n := size(all, 1);
  end f;
  type Pair = Real[2];
  function pair
    input Real x;
    output Pair p;
  algorithm
    p := {x, 2*x};
  end pair;
  Real a, n, s;
  Real p[2];
equation
  (a, n) = f({time, 3*time});
  p = pair(4*time);
  s = p[1] + p[2];
end M;
