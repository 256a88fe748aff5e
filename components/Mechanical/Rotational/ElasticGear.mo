within Mechanical.Rotational;
model ElasticGear "Gear whose teeth and shafts are elastic, with play"
  Interfaces.RotationalFlange flange_a "Driving shaft";
  Interfaces.RotationalFlange flange_b "Driven shaft";
  parameter Real ratio(unit = "1") = 1 "Angle of a over angle of b";
  parameter SI.RotationalSpringConstant c(min = 1e-6, max = 1e12, nominal = 1e4) = 1e4 "Stiffness, seen from b";
  parameter SI.RotationalDampingConstant d(min = 0, max = 1e10, nominal = 1) = 1 "Damping, seen from b";
  parameter SI.Angle b(min = 0, max = 1, nominal = 1e-3) = 0 "Total play, seen from b";
  parameter SI.Angle w(min = 1e-9, nominal = 1e-5) = 1e-5 "Angle over which a flank takes hold";
  SI.Angle phi_rel(nominal = 1e-3) "Angle by which a leads b, seen from b";
  SI.AngularVelocity w_rel(nominal = 1) "Its rate";
  SI.Torque tau(nominal = 10) "Torque on b";
  SI.Power lossPower "Power lost";
protected
  Real contact(unit = "1") "Share of the damping in force: 0 in the play, 1 in contact";
  SI.Angle bend(nominal = 1e-3) "Elastic part of phi_rel";
equation
  assert(abs(ratio) > 0, "The ratio of the gear must not be zero");
  assert(c > 0 and d >= 0 and b >= 0 and w > 0, "c and w must be positive, d and b not negative");
  phi_rel = flange_a.phi/ratio - flange_b.phi;
  w_rel = der(phi_rel);
  if b > 0 then
    bend = Smooth.ramp(phi_rel - b/2, w) - Smooth.ramp(-phi_rel - b/2, w);
    contact = Smooth.step((abs(phi_rel) - b/2)/w);
  else
    bend = phi_rel;
    contact = 1;
  end if;
  tau = c*bend + contact*d*w_rel;
  flange_b.tau = -tau;
  flange_a.tau = tau/ratio;
  lossPower = contact*d*w_rel^2;
  annotation(Documentation(info = "<html><p><code>tau = c (phi_a/ratio - phi_b) + d d/dt(..)</code> beyond the play, nothing within it; flanks take hold over the angle <code>w</code>, so that no event is needed. Power is lost in the damper only; for an efficiency add <code>LossyGear</code>.
For play without a gear see <code>ElastoBacklash</code>, which touches with an event.</p><p>Source: VDI 2737 and usual practice of drive trains: stiffness of the mesh and of the shafts in series.</p></html>"));
end ElasticGear;
