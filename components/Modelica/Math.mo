within Modelica;
package Math "Mathematical functions"
  function sin "Sine"
    input Modelica.Units.SI.Angle u "Angle";
    output Real y "sin(u)";
  external "builtin" y = sin(u);
  end sin;

  function cos "Cosine"
    input Modelica.Units.SI.Angle u "Angle";
    output Real y "cos(u)";
  external "builtin" y = cos(u);
  end cos;

  function tan "Tangent, |u| < pi/2"
    input Modelica.Units.SI.Angle u "Angle";
    output Real y "tan(u)";
  external "builtin" y = tan(u);
  end tan;

  function asin "Inverse sine, -1 <= u <= 1"
    input Real u "Sine";
    output Modelica.Units.SI.Angle y "Angle between -pi/2 and pi/2";
  external "builtin" y = asin(u);
  end asin;

  function acos "Inverse cosine, -1 <= u <= 1"
    input Real u "Cosine";
    output Modelica.Units.SI.Angle y "Angle between 0 and pi";
  external "builtin" y = acos(u);
  end acos;

  function atan "Inverse tangent"
    input Real u "Tangent";
    output Modelica.Units.SI.Angle y "Angle between -pi/2 and pi/2";
  external "builtin" y = atan(u);
  end atan;

  function atan2 "Angle of the point (u2, u1), in all four quadrants"
    input Real u1 "Ordinate";
    input Real u2 "Abscissa";
    output Modelica.Units.SI.Angle y "Angle between -pi and pi";
  external "builtin" y = atan2(u1, u2);
  end atan2;

  function atan3 "Angle of the point (u2, u1), the solution nearest to y0"
    input Real u1 "Ordinate";
    input Real u2 "Abscissa";
    input Modelica.Units.SI.Angle y0 = 0 "The result differs by at most pi from it";
    output Modelica.Units.SI.Angle y "Angle";
  protected
    constant Real turn = 2*Modelica.Constants.pi;
    Real w "Angle between -pi and pi";
  algorithm
    w := Modelica.Math.atan2(u1, u2);
    y := w + turn*floor((y0 - w)/turn + 0.5);
  end atan3;

  function sinh "Hyperbolic sine"
    input Real u;
    output Real y "sinh(u)";
  external "builtin" y = sinh(u);
  end sinh;

  function cosh "Hyperbolic cosine"
    input Real u;
    output Real y "cosh(u)";
  external "builtin" y = cosh(u);
  end cosh;

  function tanh "Hyperbolic tangent"
    input Real u;
    output Real y "tanh(u)";
  external "builtin" y = tanh(u);
  end tanh;

  function asinh "Inverse hyperbolic sine"
    input Real u;
    output Real y "asinh(u)";
  algorithm
    y := if u < 0 then -Modelica.Math.log(-u + sqrt(u*u + 1)) else Modelica.Math.log(u + sqrt(u*u + 1));
  end asinh;

  function acosh "Inverse hyperbolic cosine, u >= 1"
    input Real u;
    output Real y "acosh(u), not negative";
  algorithm
    assert(u >= 1, "acosh needs an argument of at least 1");
    y := Modelica.Math.log(u + sqrt(u*u - 1));
  end acosh;

  function atanh "Inverse hyperbolic tangent, -1 < u < 1"
    input Real u;
    output Real y "atanh(u)";
  algorithm
    y := 0.5*Modelica.Math.log((1 + u)/(1 - u));
  end atanh;

  function exp "Exponential function"
    input Real u;
    output Real y "e^u";
  external "builtin" y = exp(u);
  end exp;

  function log "Natural logarithm, u > 0"
    input Real u;
    output Real y "ln(u)";
  external "builtin" y = log(u);
  end log;

  function log10 "Logarithm of base 10, u > 0"
    input Real u;
    output Real y "log10(u)";
  external "builtin" y = log10(u);
  end log10;

  function isEqual "True where two numbers differ by at most a tolerance"
    input Real s1 "First number";
    input Real s2 "Second number";
    input Real eps(min = 0) = 0 "Tolerance, absolute";
    output Boolean result "s1 and s2 are equal";
  algorithm
    result := abs(s1 - s2) <= eps;
  end isEqual;

  package Vectors "Functions of vectors"
    function interpolate "Linear interpolation in a table, held linearly beyond its ends"
      input Real x[:] "Abscissae, strictly increasing";
      input Real y[size(x, 1)] "Ordinates";
      input Real xi "Abscissa asked for";
      input Integer iLast = 1 "Interval to begin the search with";
      output Real yi "Ordinate at xi";
      output Integer iNew = 1 "Interval of xi";
    protected
      Integer n;
      Integer i;
    algorithm
      n := size(x, 1);
      assert(n > 0, "A table needs at least one row");
      i := 1;
      if n == 1 then
        yi := y[1];
      else
        for k in 2:n - 1 loop
          if xi >= x[k] then
            i := k;
          end if;
        end for;
        yi := y[i] + (y[i + 1] - y[i])*((xi - x[i])/(x[i + 1] - x[i]));
      end if;
      iNew := i;
    end interpolate;

    function length "Euclidean length"
      input Real v[:] "Vector";
      output Real result "Length";
    algorithm
      result := sqrt(v*v);
    end length;

    function norm "Norm of order p"
      input Real v[:] "Vector";
      input Real p(min = 1) = 2 "Order";
      output Real result "Norm";
    algorithm
      result := if p == 2 then sqrt(v*v) elseif p >= Modelica.Constants.inf then max(abs(v)) else sum(abs(v[i])^p for i in 1:size(v, 1))^(1/p);
    end norm;
  end Vectors;
end Math;
