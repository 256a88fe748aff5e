//! model P.M
//! stop 3
//! s(0.51) = 1
//! s(1.89) = 2
//! k(0.51) = 1
//! k(1.89) = 2
//! lim(0.51) = 0.5
//! lim(1.89) = 1.5
//! tot(2.67) = 2
//! isLast(0.51) = 0
//! isLast(1.89) = 0
//! cnt(2.67) = 3
//! mx(2.67) = 3
package P
  type S = enumeration(idle, run, stop);
  function step
    input S s;
    output S n;
  algorithm
    n := if s == S.idle then S.run elseif s == S.run then S.stop else S.stop;
  end step;
  model M
    parameter Real L[S] = {0.5, 1.5, 0};
    S s(start = S.idle, fixed = true);
    Integer k = Integer(s);
    Real lim = L[s];
    Real tot = sum(L[i] for i in S);
    Boolean isLast = s == S.stop;
    Integer cnt = size(L, 1);
    S mxs = max(S.run, S.stop);
    Integer mx = Integer(mxs);
  equation
    when sample(1, 1) then
      s = step(pre(s));
    end when;
  end M;
end P;
