//! E010 at 4: "has no class `Presure`"
model M
  import SI = Modelica.Units.SI;
  parameter SI.Presure p = 1;
end M;
