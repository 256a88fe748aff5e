//! model P.M
//! tolerance 1e-4
//! b[1].h(0.17) = 0.8582455
//! b[1].h(0.63) = 0.239032837576
//! b[2].n(0.17) = 0
//! b[2].n(0.63) = 0
//! hits(0.17) = 0
//! hits(0.63) = 1
package P
  model Ball
    parameter Real e = 0.5;
    Real h(start = 1, fixed = true);
    Real v(start = 0, fixed = true);
    Integer n(start = 0, fixed = true);
  equation
    der(h) = v;
    der(v) = -9.81;
    when h < 0 then
      reinit(v, -e*pre(v));
      n = pre(n) + 1;
    end when;
  end Ball;
  model M
    Ball b[2](h(start = {1, 2}));
    Integer hits = sum(b.n);
  end M;
end P;
