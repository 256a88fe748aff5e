//! model P.M
//! y(0.5) = 0.125
//! area(0.5) = 0.3333333333333333
//! root(0.5) = 0.7071067811865476
//! bound(0.5) = 2.5
//! mapped[3](0.5) = 2.25
//! c(0.5) = 0.8775825618903728
//! part(0.5) = 13
package P "functions as arguments, partly applied, through loops and recursion (MLS 12.4.2)"
  partial function Law
    input Real x;
    output Real y;
  end Law;
  function square
    extends Law;
  algorithm
    y := x*x;
  end square;
  function line
    extends Law;
    input Real k = 1;
    input Real o = 0;
  algorithm
    y := k*x + o;
  end line;
  function twice
    input Law f;
    input Real x;
    output Real y = f(f(x));
  algorithm
  end twice;
  function integral "by Simpson's rule"
    input Law f;
    input Real a;
    input Real b;
    input Integer n = 10;
    output Real s;
  protected
    Real h = (b - a)/n;
  algorithm
    s := 0;
    for i in 0:n - 1 loop
      s := s + h/6*(f(a + i*h) + 4*f(a + (i + 0.5)*h) + f(a + (i + 1)*h));
    end for;
  end integral;
  function zero "by bisection"
    input Law f;
    input Real low;
    input Real high;
    output Real x;
  protected
    Real a = low;
    Real b = high;
  algorithm
    while b - a > 1e-13 loop
      x := (a + b)/2;
      if f(x)*f(a) <= 0 then
        b := x;
      else
        a := x;
      end if;
    end while;
  end zero;
  function beyond
    extends Law;
    input Real target;
  algorithm
    y := x^2 - target;
  end beyond;
  function each_
    input Law f;
    input Real v[:];
    output Real y[size(v, 1)] = {f(v[i]) for i in 1:size(v, 1)};
  algorithm
  end each_;
  function via
    input Law f;
    input Real x;
    output Real y = twice(f, x);
  algorithm
  end via;
  model M
    parameter Real k = 3;
    Real y = 2*twice(square, time);
    Real area = integral(square, 0, 2*time);
    Real root = zero(function beyond(target = time), 0, 2);
    Real bound = twice(function line(k = 2*time, o = 1), time);
    Real mapped[3] = each_(square, {1, 2, 3}*time);
    Real c = each_(Modelica.Math.cos, {time})*{1};
    Real part = via(function line(k = k, o = 2), 4*time*0.5/3*(k/1)) + 0*time - 4;
  end M;
end P;
