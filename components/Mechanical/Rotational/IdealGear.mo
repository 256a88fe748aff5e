within Mechanical.Rotational;
model IdealGear "Gear without loss"
  Interfaces.RotationalFlange flange_a "Driving shaft";
  Interfaces.RotationalFlange flange_b "Driven shaft";
  parameter Real ratio(unit = "1") = 1 "Angle of a over angle of b";
equation
  assert(abs(ratio) > 0, "The ratio of the gear must not be zero");
  flange_a.phi = ratio*flange_b.phi;
  ratio*flange_a.tau + flange_b.tau = 0;
  annotation(Documentation(info = "<html><p><code>phi_a = ratio phi_b</code>, power is passed on without loss. With losses: <code>LossyGear</code>, elastic: <code>ElasticGear</code>.</p></html>"));
end IdealGear;
