within Electrical.Drives;
model IdealEncoder "Exact speed of a shaft"
  Interfaces.RotationalFlange flange "Shaft";
  Interfaces.RealOutput w(unit = "rad/s") "Speed";
equation
  flange.tau = 0;
  w = der(flange.phi);
  annotation(Documentation(info = "<html><p>Exact and without delay; the real one is <code>Encoder</code>.</p></html>"));
end IdealEncoder;
