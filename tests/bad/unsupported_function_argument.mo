//! model P.M
//! E017 at 15: "a function as an argument"
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
    Real y = twice(half, time);
    function half
      input Real x;
      output Real y = x/2;
    algorithm
    end half;
  end M;
end P;
