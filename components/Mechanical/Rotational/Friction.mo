within Mechanical.Rotational;
model Friction "Dry friction between two flanges with sticking: Coulomb, Stribeck and viscous part"
  extends Bases.Compliant;
  extends Bases.DryFriction;
  parameter SI.Torque tau_c(min = 0, nominal = 1) = 1 "Coulomb torque";
  parameter SI.Torque tau_s(min = 0, nominal = 1) = tau_c "Torque of sliding at vanishing speed, at least the Coulomb torque";
  parameter SI.AngularVelocity w_s(min = 1e-6, nominal = 1) = 1 "Stribeck speed";
  parameter Real delta(unit = "1", min = 1, max = 4) = 2 "Exponent of the Stribeck curve: 2 Gauss, 1 Tustin";
  parameter SI.RotationalDampingConstant d(min = 0, nominal = 1) = 0 "Viscous friction";
  parameter Real peak(unit = "1", min = 1, max = 10) = 1 "Holding torque over tau_s";
  SI.AngularVelocity w_rel(start = 0, nominal = 10) "Relative speed";
  SI.AngularAcceleration a_rel "Relative acceleration";
  SI.Power lossPower "Power lost";
equation
  assert(tau_c >= 0 and tau_s >= tau_c, "tau_c must not be negative and tau_s not below it");
  assert(w_s > 0 and peak >= 1 and d >= 0, "w_s must be positive, peak at least 1, d not negative");
  w_rel = der(phi_rel);
  a_rel = der(w_rel);
  w_slide = w_rel;
  a_slide = a_rel;
  free = false;
  tau_0 = tau_s;
  tau_hold = peak*tau_s;
  tau_dry = tau_c + (tau_s - tau_c)*exp(-(noEvent(abs(w_rel))/w_s)^delta);
  tau_visc = d*w_rel;
  tau = tau_fric;
  lossPower = tau*w_rel;
  annotation(Documentation(info = "<html>
<p><code>tau = (tau_c + (tau_s - tau_c) exp(-(|v|/w_s)^delta)) sign(v) + d v</code> while sliding; at rest the contact holds up to <code>peak*tau_s</code>. Exact to the event (<code>Bases.DryFriction</code>). Join one flange to <code>Fixed</code> for friction against the housing. Passive: <code>tau v >= 0</code>.</p>
<p>Source: B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083.</p></html>"));
end Friction;
