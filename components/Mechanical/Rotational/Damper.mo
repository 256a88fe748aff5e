within Mechanical.Rotational;
model Damper "Linear damper"
  extends Bases.Compliant;
  parameter SI.RotationalDampingConstant d(min = 0, max = 1e10, nominal = 1) = 1 "Damping";
  SI.AngularVelocity w_rel(nominal = 10) "Relative speed";
  SI.Power lossPower "Power lost";
equation
  assert(d >= 0, "The damping d must not be negative");
  w_rel = der(phi_rel);
  tau = d*w_rel;
  lossPower = tau*w_rel;
  annotation(Documentation(info = "<html><p><code>tau = d w_rel</code>; power is lost in it, never given.</p></html>"));
end Damper;
