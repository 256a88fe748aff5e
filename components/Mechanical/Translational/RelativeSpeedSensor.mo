within Mechanical.Translational;
model RelativeSpeedSensor "Speed of one flange relative to another"
  Interfaces.TranslationalFlange flange_a "First flange";
  Interfaces.TranslationalFlange flange_b "Second flange";
  Interfaces.RealOutput v_rel(unit = "m/s", nominal = 0.1) "Speed of b relative to a";
equation
  v_rel = der(flange_b.s) - der(flange_a.s);
  flange_a.f = 0;
  flange_b.f = 0;
  annotation(Documentation(info = "<html><p><code>v_rel = v_b - v_a</code>, without force.</p></html>"));
end RelativeSpeedSensor;
