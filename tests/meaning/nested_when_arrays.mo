//! model P.M
//! stop 2.5
//! c.q[1](0.425) = 0
//! c.q[1](1.575) = 1
//! c.q[2](0.425) = 0
//! c.q[2](1.575) = 2
//! s(0.425) = 0
//! s(1.575) = 3
//! last(0.425) = 0
//! last(1.575) = 1
package P
  record R
    Real t;
    Integer n;
  end R;
  model C
    parameter Integer n = 2;
    discrete Real q[n](each start = 0, each fixed = true);
    R r(t(start = 0, fixed = true), n(start = 0, fixed = true));
  equation
    when sample(1, 1) then
      q = pre(q) + {i for i in 1:n};
      r.t = time;
      r.n = pre(r.n) + 1;
    end when;
  end C;
  model M
    C c;
    Real s = sum(c.q);
    Integer last = c.r.n;
    Real lt = c.r.t;
  end M;
end P;
