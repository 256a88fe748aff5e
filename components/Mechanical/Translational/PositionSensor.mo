within Mechanical.Translational;
model PositionSensor "Position of a flange"
  Interfaces.TranslationalFlange flange "Flange";
  Interfaces.RealOutput s(unit = "m") "Position";
equation
  s = flange.s;
  flange.f = 0;
  annotation(Documentation(info = "<html><p>Without force.</p></html>"));
end PositionSensor;
