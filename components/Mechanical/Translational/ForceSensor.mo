within Mechanical.Translational;
model ForceSensor "Force that passes from a to b"
  Interfaces.TranslationalFlange flange_a "Flange a";
  Interfaces.TranslationalFlange flange_b "Flange b";
  Interfaces.RealOutput f(unit = "N") "Force passed on, positive when a pushes b forward";
equation
  flange_a.s = flange_b.s;
  flange_a.f + flange_b.f = 0;
  f = flange_a.f;
  annotation(Documentation(info = "<html><p>The force that a passes to b, without influence.</p></html>"));
end ForceSensor;
