within Mechanical.Translational;
model Brake "Friction brake or clamp of a rod against the housing, engaged by a signal, with sticking"
  extends Bases.DryFriction;
  Interfaces.TranslationalFlange flange_a "Left flange";
  Interfaces.TranslationalFlange flange_b "Right flange, moves with the left one";
  parameter Real mu_c(unit = "1", min = 0, max = 1) = 0.4 "Coefficient of sliding friction";
  parameter Real peak(unit = "1", min = 1, max = 10) = 1 "Coefficient of holding over that of sliding";
  parameter Real cgeo(unit = "1", min = 1e-9) = 1 "Number of faces";
  parameter SI.Force fn_max(min = 0) = 1 "Normal force at f_normalized = 1";
  Interfaces.RealInput f_normalized "Normal force over fn_max; not positive: open";
  SI.Position s(nominal = 1e-2) "Position";
  SI.Velocity v(start = 0, nominal = 0.1) "Velocity";
  SI.Acceleration a "Acceleration";
  SI.Force f "Brake force";
  SI.Power lossPower "Power lost";
protected
  SI.Force f_n "Normal force";
equation
  assert(mu_c >= 0 and peak >= 1 and cgeo > 0, "mu_c must not be negative, peak at least 1, cgeo positive");
  flange_a.s = s;
  flange_b.s = s;
  v = der(s);
  a = der(v);
  v_slide = v;
  a_slide = a;
  free = f_normalized <= 0;
  f_n = fn_max*max(f_normalized, 0);
  f_0 = mu_c*cgeo*f_n;
  f_hold = peak*mu_c*cgeo*f_n;
  f_dry = f_0;
  f_visc = 0;
  f = f_fric;
  flange_a.f + flange_b.f - f = 0;
  lossPower = f*v;
  annotation(Documentation(info = "<html><p>Force up to <code>peak mu_c cgeo f_n</code> while it holds, <code>mu_c cgeo f_n</code> while it slips: the clamp that holds a rod when the pressure fails. Closing, sticking and slipping are events. Source: M. Otter, H. Elmqvist, S. E. Mattsson, CACSD 1999.</p></html>"));
end Brake;
