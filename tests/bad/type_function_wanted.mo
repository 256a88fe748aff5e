//! model P.M
//! E021 at 15: "input `f` of `P.twice` is a function, and this is a Real"
package P
  partial function I
    input Real x;
    output Real y;
  end I;
  function twice
    input I f;
    input Real x;
    output Real y = f(f(x));
  algorithm
  end twice;
  model M
    Real y = twice(time, time);
  end M;
end P;
