//! model P.M
//! stop 2
//! n(0.34) = 0
//! n(1.26) = 2
//! v[2](0.34) = 0.68
//! v[2](1.26) = 2.52
//! r.lo(0.34) = 0.34
//! r.lo(1.26) = 0.7
package P
  record R
    Real lo;
    Real hi;
  end R;
  function f
    input Real x;
    input Real y;
    output R r;
  algorithm
    r := if x < y then R(x, y) else R(y, x);
  end f;
  function count
    input Real t;
    input Real th[:];
    output Integer n;
  algorithm
    n := 0;
    for x in th loop
      if t >= x then
        n := n + 1;
      end if;
    end for;
  end count;
  function vec
    input Real a;
    input Integer n = 3;
    output Real v[n];
  algorithm
    for i in 1:n loop
      v[i] := i*a;
    end for;
  end vec;
  model M
    Integer n(start = 0, fixed = true);
    Real v[3] = vec(time);
    R r = f(time, 0.7);
  equation
    when {time >= 0.5, time >= 1, time >= 1.5} then
      n = count(time, {0.5, 1, 1.5});
    end when;
  end M;
end P;
