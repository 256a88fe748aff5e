//! model K.M
//! a(0.5) = 150
//! b(0.5) = 150
//! d(0.5) = 150
//! e(0.5) = 7.5
package K
  partial function Law
    input Real x;
    input Real k = 1;
    output Real y;
  end Law;
  function Lin
    extends Law;
    input Real c = 2;
  algorithm
    y := k*c*x;
  end Lin;
  function Use
    input Real x;
    replaceable function f = Lin constrainedby Law;
    output Real y;
  algorithm
    y := f(x);
  end Use;
  model Fl
    parameter Real k = 10;
    parameter Real c = 3;
    replaceable function f = Lin(c = c) constrainedby Law(k = k);
    function g = f;
    function five = f(k = 5);
    function u = Use(redeclare function f = f);
  end Fl;
  model M
    Fl fl(k = 100);
    Real a = fl.f(time);
    Real b = fl.g(time);
    Real d = fl.u(time);
    // what is said where the class is used comes before its constraint
    Real e = fl.five(time);
  end M;
end K;
