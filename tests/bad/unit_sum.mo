//! W230 at 9: "m/s"
model M
  import Modelica.Units.SI;
  SI.Length s(start = 0, fixed = true);
  parameter SI.Velocity v = 1;
  SI.Length x;
equation
  der(s) = v;
  x = s + v;
end M;
