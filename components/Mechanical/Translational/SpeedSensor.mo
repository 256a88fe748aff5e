within Mechanical.Translational;
model SpeedSensor "Speed of a flange"
  Interfaces.TranslationalFlange flange "Flange";
  Interfaces.RealOutput v(unit = "m/s") "Speed";
equation
  v = der(flange.s);
  flange.f = 0;
  annotation(Documentation(info = "<html><p>Without force.</p></html>"));
end SpeedSensor;
