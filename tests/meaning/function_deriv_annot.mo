//! model P.M
//! y(0.17) = 0.00484245007952
//! y(0.63) = 0.204487164741
//! v(0.17) = 0.0846301944479
//! v(0.63) = 0.841378550753
//! a(0.17) = 0.971512043686
//! a(0.63) = 1.69448406499
package P
  function cube
    input Real x;
    output Real y;
  algorithm
    y := x^3;
    annotation(derivative = cube_der);
  end cube;
  function cube_der
    input Real x;
    input Real dx;
    output Real dy;
  algorithm
    dy := 3*x^2*dx;
    annotation(derivative(order = 2) = cube_der2);
  end cube_der;
  function cube_der2
    input Real x;
    input Real dx;
    input Real ddx;
    output Real ddy;
  algorithm
    ddy := 6*x*dx^2 + 3*x^2*ddx;
  end cube_der2;
  model M
    Real x = sin(time);
    Real y = cube(x);
    Real v = der(y);
    Real a = der(v);
  end M;
end P;
