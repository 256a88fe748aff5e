within Mechanical.Rotational;
model Fixed "Flange fixed to the housing"
  parameter SI.Angle phi0 = 0 "Angle of the housing";
  Interfaces.RotationalFlange flange "Flange";
equation
  flange.phi = phi0;
  annotation(Documentation(info = "<html><p>Holds a flange still.</p></html>"));
end Fixed;
