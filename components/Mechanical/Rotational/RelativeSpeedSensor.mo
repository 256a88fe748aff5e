within Mechanical.Rotational;
model RelativeSpeedSensor "Speed of one flange relative to another"
  Interfaces.RotationalFlange flange_a "First flange";
  Interfaces.RotationalFlange flange_b "Second flange";
  Interfaces.RealOutput w_rel(unit = "rad/s", nominal = 10) "Speed of b relative to a";
equation
  w_rel = der(flange_b.phi) - der(flange_a.phi);
  flange_a.tau = 0;
  flange_b.tau = 0;
  annotation(Documentation(info = "<html><p><code>w_rel = w_b - w_a</code>, without torque.</p></html>"));
end RelativeSpeedSensor;
