//! E001 at 8: "the function `P.f` holds an equation"
//! model P.M
package P
  function f
    input Real x;
    output Real y;
  equation
    y = x;
  end f;
  model M
    Real y = f(time);
  end M;
end P;
