within Hydraulic.SealFriction;
model Sticking "Coulomb, Stribeck and viscous friction with exact sticking (events)"
  extends Law;
  extends Mechanical.Translational.Bases.DryFriction;
  parameter SI.Force F_0(min = 0, max = 1e6, nominal = 100) = 300 "Coulomb friction without pressure";
  parameter SI.Area k_c(min = 0, max = 1, nominal = 1e-5) = 5e-5 "Coulomb friction per sum of the pressures";
  parameter Real k_st(unit = "1", min = 1, max = 5) = 1.3 "Break-away friction over Coulomb friction";
  parameter SI.Velocity v_s(min = 1e-6, max = 1, nominal = 1e-2) = 5e-3 "Stribeck speed";
  parameter SI.TranslationalDampingConstant B(min = 0, max = 1e8, nominal = 1e3) = 2000 "Viscous friction";
  SI.Velocity v(start = 0, nominal = 0.1) "Velocity";
protected
  SI.Force F_c(nominal = 100) "Coulomb friction";
equation
  assert(F_0 >= 0 and k_c >= 0 and B >= 0 and k_st >= 1, "F_0, k_c and B must not be negative, k_st at least 1");
  v = der(flange.s);
  v_slide = v;
  a_slide = der(v);
  free = false;
  F_c = F_0 + k_c*(max(p_1, 0) + max(p_2, 0));
  f_0 = k_st*F_c;
  f_hold = k_st*F_c;
  f_dry = F_c*(1 + (k_st - 1)*exp(-(v/v_s)^2));
  f_visc = B*v;
  f = f_fric;
  annotation(Documentation(info = "<html><p>Coulomb friction that grows with both pressures, Stribeck curve, and exact sticking by events (Karnopp's idea without its band). For holding loads; <code>Stribeck</code> is smoother, <code>LuGre</code> has bristles. Valid for seals without bristles: before it slides nothing moves. Source: D. Karnopp, J. Dyn. Syst. Meas. Control 107 (1985) 100; curve: B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083.</p></html>"));
end Sticking;
