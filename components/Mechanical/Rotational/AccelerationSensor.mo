within Mechanical.Rotational;
model AccelerationSensor "Acceleration of a flange"
  Interfaces.RotationalFlange flange "Flange";
  Interfaces.RealOutput a(unit = "rad/s2") "Acceleration";
  SI.AngularVelocity w "Speed";
equation
  w = der(flange.phi);
  a = der(w);
  flange.tau = 0;
  annotation(Documentation(info = "<html><p>Without torque.</p></html>"));
end AccelerationSensor;
