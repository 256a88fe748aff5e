//! W230 at 10: "m/s"
model M
  import Modelica.Units.SI;
  parameter SI.Area A = 1e-4;
  parameter SI.Pressure p = 1e5;
  Real product;
  SI.Velocity v;
equation
  product = p*A;
  v = product;
end M;
