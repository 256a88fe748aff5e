//! W231 at 7: "rev/min"
model M
  import Modelica.Units.SI;
  parameter Real n(unit = "rev/min") = 1500;
  SI.AngularVelocity w;
equation
  w = n;
end M;
