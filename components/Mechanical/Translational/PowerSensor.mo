within Mechanical.Translational;
model PowerSensor "Power that passes from a to b"
  Interfaces.TranslationalFlange flange_a "Flange a";
  Interfaces.TranslationalFlange flange_b "Flange b";
  Interfaces.RealOutput power(unit = "W") "Power passed on";
equation
  flange_a.s = flange_b.s;
  flange_a.f + flange_b.f = 0;
  power = flange_a.f*der(flange_a.s);
  annotation(Documentation(info = "<html><p>Power from a to b, without influence.</p></html>"));
end PowerSensor;
