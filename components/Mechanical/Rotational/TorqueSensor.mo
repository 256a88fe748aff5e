within Mechanical.Rotational;
model TorqueSensor "Torque that passes from a to b"
  Interfaces.RotationalFlange flange_a "Flange a";
  Interfaces.RotationalFlange flange_b "Flange b";
  Interfaces.RealOutput tau(unit = "N.m") "Torque passed on, positive when a pushes b forward";
equation
  flange_a.phi = flange_b.phi;
  flange_a.tau + flange_b.tau = 0;
  tau = flange_a.tau;
  annotation(Documentation(info = "<html><p>The torque that a passes to b, without influence.</p></html>"));
end TorqueSensor;
