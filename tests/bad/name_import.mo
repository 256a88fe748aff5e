//! E010 at 3: "`Modelica.Units` has no class `SII`"
model M
  import Modelica.Units.SII;
  parameter SII.Pressure p = 1;
end M;
