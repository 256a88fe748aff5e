//! W230 at 7: "Pa"
model M
  import Modelica.Units.SI;
  parameter SI.Pressure p = 1e5;
  SI.VolumeFlowRate q;
equation
  q = p;
end M;
