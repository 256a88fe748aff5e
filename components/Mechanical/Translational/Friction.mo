within Mechanical.Translational;
model Friction "Dry friction between two flanges with sticking: Coulomb, Stribeck and viscous part"
  extends Bases.Compliant;
  extends Bases.DryFriction;
  parameter SI.Force f_c(min = 0, nominal = 100) = 10 "Coulomb force";
  parameter SI.Force f_s(min = 0, nominal = 100) = f_c "Force of sliding at vanishing speed, at least the Coulomb force";
  parameter SI.Velocity v_s(min = 1e-6, nominal = 1e-2) = 1e-2 "Stribeck speed";
  parameter Real delta(unit = "1", min = 1, max = 4) = 2 "Exponent of the Stribeck curve: 2 Gauss, 1 Tustin";
  parameter SI.TranslationalDampingConstant d(min = 0, nominal = 1e3) = 0 "Viscous friction";
  parameter Real peak(unit = "1", min = 1, max = 10) = 1 "Holding force over f_s";
  SI.Velocity v_rel(start = 0, nominal = 0.1) "Relative speed";
  SI.Acceleration a_rel "Relative acceleration";
  SI.Power lossPower "Power lost";
equation
  assert(f_c >= 0 and f_s >= f_c, "f_c must not be negative and f_s not below it");
  assert(v_s > 0 and peak >= 1 and d >= 0, "v_s must be positive, peak at least 1, d not negative");
  v_rel = der(s_rel);
  a_rel = der(v_rel);
  v_slide = v_rel;
  a_slide = a_rel;
  free = false;
  f_0 = f_s;
  f_hold = peak*f_s;
  f_dry = f_c + (f_s - f_c)*exp(-(noEvent(abs(v_rel))/v_s)^delta);
  f_visc = d*v_rel;
  f = f_fric;
  lossPower = f*v_rel;
  annotation(Documentation(info = "<html>
<p><code>f = (f_c + (f_s - f_c) exp(-(|v|/v_s)^delta)) sign(v) + d v</code> while sliding; at rest the contact holds up to <code>peak*f_s</code>. Exact to the event (<code>Bases.DryFriction</code>). Join one flange to <code>Fixed</code> for friction against the housing. Passive: <code>f v >= 0</code>.</p>
<p>Source: B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083.</p></html>"));
end Friction;
