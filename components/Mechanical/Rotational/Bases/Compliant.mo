within Mechanical.Rotational.Bases;
partial model Compliant "Two flanges joined without inertia: torque over relative angle"
  Interfaces.RotationalFlange flange_a "Flange a";
  Interfaces.RotationalFlange flange_b "Flange b";
  SI.Angle phi_rel(start = 0) "Angle of b relative to a";
  SI.Torque tau(start = 0) "Torque between the flanges, positive when it pulls b towards a";
equation
  phi_rel = flange_b.phi - flange_a.phi;
  flange_b.tau = tau;
  flange_a.tau = -tau;
end Compliant;
