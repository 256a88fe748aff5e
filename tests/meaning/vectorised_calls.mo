//! model P.M
//! u[2](0.5) = 8
//! w(0.5) = 9.75
//! m[2,3](0.5) = 30.5
//! k(0.5) = 16
//! rows[2](0.5) = 5.5
//! g[3](0.5) = 3.25
//! s[3](0.5) = 7.5
//! t(0.5) = 7
//! z(0.5) = 3
package P "functions of single values called with arrays: element by element (MLS 12.4.6)"
  record R
    Real a;
    Real b;
  end R;
  function sq
    input Real x;
    output Real y = x*x;
  algorithm
  end sq;
  function lin
    input Real u;
    input Real k = 2;
    input Real o = 0.5;
    output Real y = k*u + o;
  algorithm
  end lin;
  function both
    input Real x;
    output Real double = 2*x;
    output Real half = x/2;
  algorithm
  end both;
  function total
    input Real v[:];
    output Real s = sum(v);
  algorithm
  end total;
  function of
    input R r;
    output Real s = r.a + r.b;
  algorithm
  end of;
  function steps "no single expression"
    input Real x;
    output Integer n;
  algorithm
    n := 0;
    while n < x loop
      n := n + 1;
    end while;
  end steps;
  model M
    Real u[2] = sq({1, 4*time*sqrt(2)});
    Real w = sum(sq(time*{1, 2, 3})) + sq(2.5);
    Real m[2, 3] = lin([1, 2, 3; 4, 5, 6], 5);
    Real k = sum(lin({time, 2*time, 3*time}, {2, 4, 6}, o = 1) - {1, 0, 0});
    Real rows[2] = total([1, 2*time; 2*time, 4.5]);
    Real d[3], h[3];
    Real g[3] = d + h;
    R r[3](a = {1, 2, 3}, each b = 9*time);
    Real s[3] = of(r);
    Real t = sum(steps({time, 2.2*time, 8*time}));
    Real none[0] = sq(zeros(0));
    Real z = 3 + sum(none);
  equation
    (d, h) = both({time, 2*time, 2.6*time});
  end M;
end P;
