within Mechanical.Rotational;
model PowerSensor "Power that passes from a to b"
  Interfaces.RotationalFlange flange_a "Flange a";
  Interfaces.RotationalFlange flange_b "Flange b";
  Interfaces.RealOutput power(unit = "W") "Power passed on";
equation
  flange_a.phi = flange_b.phi;
  flange_a.tau + flange_b.tau = 0;
  power = flange_a.tau*der(flange_a.phi);
  annotation(Documentation(info = "<html><p>Power from a to b, without influence.</p></html>"));
end PowerSensor;
