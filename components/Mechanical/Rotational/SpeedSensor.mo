within Mechanical.Rotational;
model SpeedSensor "Speed of a flange"
  Interfaces.RotationalFlange flange "Flange";
  Interfaces.RealOutput w(unit = "rad/s") "Speed";
equation
  w = der(flange.phi);
  flange.tau = 0;
  annotation(Documentation(info = "<html><p>Without torque.</p></html>"));
end SpeedSensor;
