//! model P.M
//! y(0.17) = 2.06814150222
//! y(0.63) = 4.95840674352
//! z(0.17) = 1.6671305
//! z(0.63) = 6.1781895
//! w(0.89) = 6
//! u(0.17) = 0.51
//! u(0.63) = 1.89
package P
  package Inner
    constant Real one = 1;
    constant Real arr[3] = {1, 2, 3};
    package Deeper
      constant Real k = arr[2]*3;
      function f
        input Real x;
        output Real y = x*arr[3];
      algorithm
      end f;
    end Deeper;
  end Inner;
  model M
    import Modelica.Constants.{pi, g_n};
    import SI = Modelica.Units.SI;
    import P.Inner.Deeper;
    Real y = 2*pi*time + Inner.one;
    Real z = g_n*time;
    Real w = Deeper.k;
    Real u = Deeper.f(time);
    SI.Pressure p = 1e5;
    parameter SI.Length l[2] = {1, 2};
  end M;
end P;
