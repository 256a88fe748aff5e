within Mechanical.Translational;
model AccelerationSensor "Acceleration of a flange"
  Interfaces.TranslationalFlange flange "Flange";
  Interfaces.RealOutput a(unit = "m/s2") "Acceleration";
  SI.Velocity v "Speed";
equation
  v = der(flange.s);
  a = der(v);
  flange.f = 0;
  annotation(Documentation(info = "<html><p>Without force.</p></html>"));
end AccelerationSensor;
