within Mechanical.Translational;
model Fixed "Flange fixed to the housing"
  parameter SI.Position s0 = 0 "Position of the housing";
  Interfaces.TranslationalFlange flange "Flange";
equation
  flange.s = s0;
  annotation(Documentation(info = "<html><p>Holds a flange still.</p></html>"));
end Fixed;
