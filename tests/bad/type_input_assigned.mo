//! E210 at 8: "`x` is an input of `P.f` and cannot be assigned to"
//! model P.M
package P
  function f
    input Real x;
    output Real y;
  algorithm
    x := 2;
    y := x;
  end f;
  model M
    Real y = f(time);
  end M;
end P;
