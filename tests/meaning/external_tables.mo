//! stop 4
//! y(0.52) = 1.04
//! y(2.52) = 3.52
//! slope(0.52) = 2
//! z(1) = 4
//! held(2.52) = 2
//! stepped(1.52) = 1
//! stepped(2.52) = 5
//! low(0) = 0
//! n(0) = 6
//! part(0) = 2

model M
  type Smoothness = enumeration(Linear, Akima, Constant, Monotone1, Monotone2, Makima);
  type Outside = enumeration(Hold, Slope, Periodic, None);
  class Curve
    extends ExternalObject;
    function constructor
      input Real table[:, :];
      input Integer columns[:];
      input Smoothness smoothness;
      input Outside outside;
      output Curve curve;
    protected String file = "NoName";
    external "C" curve = ModelicaStandardTables_CombiTable1D_init3("NoName", "NoName", table, size(table, 1), size(table, 2),
        columns, size(columns, 1), smoothness, outside, true, ",", 0);
    end constructor;
    function destructor
      input Curve curve;
    external "C" ModelicaStandardTables_CombiTable1D_close(curve);
    end destructor;
  end Curve;
  function value
    input Curve curve;
    input Integer column;
    input Real u;
    output Real y;
  external "C" y = ModelicaStandardTables_CombiTable1D_getValue(curve, column, u);
  end value;
  function least
    input Curve curve;
    output Real u;
  external "C" u = ModelicaStandardTables_CombiTable1D_minimumAbscissa(curve);
  end least;
  function length
    input String text;
    output Integer n;
  external "C" n = ModelicaStrings_length(text);
  end length;
  function substring
    input String text;
    input Integer from, to;
    output String part;
  external "C" part = ModelicaStrings_substring(text, from, to);
  end substring;
  parameter Curve curve = Curve([0, 0; 1, 2; 2, 3; 3, 4], {2}, Smoothness.Linear, Outside.Slope);
  parameter Curve two = Curve([0, 0, 0; 1, 2, 4; 2, 2, 9], {3, 2}, Smoothness.Linear, Outside.Hold);
  parameter Curve steps = Curve([0, 0; 1, 1; 2, 5], {2}, Smoothness.Constant, Outside.Hold);
  parameter Real low = least(curve);
  parameter Integer n = length("piston");
  parameter Integer part = if substring("piston", 1, 4) == "pist" then 2 else 1;
  Real y = value(curve, 1, time);
  Real slope = der(y);
  Real z = value(two, 1, 1);
  Real held = value(two, 2, time);
  Real stepped = value(steps, 1, time);
end M;
