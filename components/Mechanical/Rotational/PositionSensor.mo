within Mechanical.Rotational;
model PositionSensor "Angle of a flange"
  Interfaces.RotationalFlange flange "Flange";
  Interfaces.RealOutput phi(unit = "rad") "Angle";
equation
  phi = flange.phi;
  flange.tau = 0;
  annotation(Documentation(info = "<html><p>Without torque.</p></html>"));
end PositionSensor;
