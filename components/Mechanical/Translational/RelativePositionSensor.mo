within Mechanical.Translational;
model RelativePositionSensor "Position of one flange relative to another"
  Interfaces.TranslationalFlange flange_a "First flange";
  Interfaces.TranslationalFlange flange_b "Second flange";
  Interfaces.RealOutput s_rel(unit = "m", nominal = 1e-2) "Position of b relative to a";
equation
  s_rel = flange_b.s - flange_a.s;
  flange_a.f = 0;
  flange_b.f = 0;
  annotation(Documentation(info = "<html><p><code>s_rel = s_b - s_a</code>, without force.</p></html>"));
end RelativePositionSensor;
