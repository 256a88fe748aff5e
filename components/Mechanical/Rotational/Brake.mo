within Mechanical.Rotational;
model Brake "Friction brake against the housing, engaged by a signal, with sticking"
  extends Bases.DryFriction;
  Interfaces.RotationalFlange flange_a "Left flange";
  Interfaces.RotationalFlange flange_b "Right flange, moves with the left one";
  parameter Real mu_c(unit = "1", min = 0, max = 1) = 0.4 "Coefficient of sliding friction";
  parameter Real peak(unit = "1", min = 1, max = 10) = 1 "Coefficient of holding over that of sliding";
  parameter SI.Length cgeo(min = 1e-9) = 1 "Mean radius times number of faces";
  parameter SI.Force fn_max(min = 0) = 1 "Normal force at f_normalized = 1";
  Interfaces.RealInput f_normalized "Normal force over fn_max; not positive: open";
  SI.Angle phi "Angle";
  SI.AngularVelocity w(start = 0, nominal = 10) "Angular velocity";
  SI.AngularAcceleration a "Angular acceleration";
  SI.Torque tau "Brake torque";
  SI.Power lossPower "Power lost";
protected
  SI.Force f_n "Normal force";
equation
  assert(mu_c >= 0 and peak >= 1 and cgeo > 0, "mu_c must not be negative, peak at least 1, cgeo positive");
  flange_a.phi = phi;
  flange_b.phi = phi;
  w = der(phi);
  a = der(w);
  w_slide = w;
  a_slide = a;
  free = f_normalized <= 0;
  f_n = fn_max*max(f_normalized, 0);
  tau_0 = mu_c*cgeo*f_n;
  tau_hold = peak*mu_c*cgeo*f_n;
  tau_dry = tau_0;
  tau_visc = 0;
  tau = tau_fric;
  flange_a.tau + flange_b.tau - tau = 0;
  lossPower = tau*w;
  annotation(Documentation(info = "<html><p>As <code>Clutch</code>, against the housing.</p></html>"));
end Brake;
