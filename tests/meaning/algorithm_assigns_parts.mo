//! model P.M
//! stop 2
//! s[1].v(1) = 1
//! s[1].w(1) = 2
//! s[2].v(1) = 2
//! s[2].w(1) = 4
//! s[2].y[2](1) = 4
//! r.a(1) = 3
//! r.b(1) = 7
//! z(1) = 5
//! k.n(0.5) = 0
//! k.n(1.5) = 1
// Variables of components in an algorithm: what is not assigned keeps its equation, of records too.
package P
  record R
    Real a, b;
  end R;
  model Sub
    Real v;
    Real w = 2*v;
    Real y[2];
  end Sub;
  model Counter
    Integer n(start = 0, fixed = true);
    Real v;
  end Counter;
  model M
    Sub s[2];
    R r;
    Counter k;
    Real z;
  algorithm
    for i in 1:2 loop
      s[i].v := i*time;
      s[i].y[1] := 1;
      s[i].y[2] := s[i].w;
    end for;
    r.a := 3;
    k.v := 2*time;
    when time > 1 then
      k.n := pre(k.n) + 1;
    end when;
    z := s[2].y[2] + s[1].y[1];
  equation
    r.b = 7;
  end M;
end P;
