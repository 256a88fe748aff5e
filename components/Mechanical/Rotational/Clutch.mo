within Mechanical.Rotational;
model Clutch "Friction clutch engaged by a signal, with sticking"
  extends Bases.Compliant;
  extends Bases.DryFriction;
  parameter Real mu_c(unit = "1", min = 0, max = 1) = 0.4 "Coefficient of sliding friction";
  parameter Real peak(unit = "1", min = 1, max = 10) = 1 "Coefficient of holding over that of sliding";
  parameter SI.Length cgeo(min = 1e-9) = 1 "Mean radius times number of faces";
  parameter SI.Force fn_max(min = 0) = 1 "Normal force at f_normalized = 1";
  Interfaces.RealInput f_normalized "Normal force over fn_max; not positive: open";
  SI.AngularVelocity w_rel(start = 0, nominal = 10) "Relative speed";
  SI.AngularAcceleration a_rel "Relative acceleration";
  SI.Power lossPower "Power lost";
protected
  SI.Force f_n "Normal force";
equation
  assert(mu_c >= 0 and peak >= 1 and cgeo > 0, "mu_c must not be negative, peak at least 1, cgeo positive");
  w_rel = der(phi_rel);
  a_rel = der(w_rel);
  w_slide = w_rel;
  a_slide = a_rel;
  free = f_normalized <= 0;
  f_n = fn_max*max(f_normalized, 0);
  tau_0 = mu_c*cgeo*f_n;
  tau_hold = peak*mu_c*cgeo*f_n;
  tau_dry = tau_0;
  tau_visc = 0;
  tau = tau_fric;
  lossPower = tau*w_rel;
  annotation(Documentation(info = "<html><p>Torque up to <code>peak mu_c cgeo f_n</code> while the halves turn together, <code>mu_c cgeo f_n</code> while they slip; the normal force follows the command. Closing, sticking and slipping are events. Source: M. Otter, H. Elmqvist, S. E. Mattsson, CACSD 1999.</p></html>"));
end Clutch;
