within Hydraulic.SealFriction;
model LuGre "LuGre friction: bristles between seal and rod"
  extends Law;
  parameter SI.Force F_0(min = 1e-3, max = 1e6, nominal = 100) = 300 "Coulomb friction without pressure";
  parameter SI.Area k_c(min = 0, max = 1, nominal = 1e-5) = 5e-5 "Coulomb friction per sum of the pressures";
  parameter Real k_st(unit = "1", min = 1, max = 5) = 1.3 "Break-away friction over Coulomb friction";
  parameter SI.Velocity v_s(min = 1e-6, max = 1, nominal = 1e-2) = 5e-3 "Stribeck speed";
  parameter SI.TranslationalDampingConstant B(min = 0, max = 1e8, nominal = 1e3) = 2000 "Viscous friction";
  parameter SI.TranslationalSpringConstant sigma_0(min = 1, max = 1e12, nominal = 1e7) = 1e7 "Stiffness of the bristles";
  parameter SI.TranslationalDampingConstant sigma_1(min = 0, max = 1e8, nominal = 1e4) = 2e4 "Damping of the bristles at standstill";
  parameter SI.Velocity v_d(min = 1e-6, max = 1, nominal = 1e-3) = 1e-3 "Speed over which the damping of the bristles fades";
  SI.Velocity v(nominal = 0.1) "Velocity";
  SI.Length z(start = 0, fixed = true, nominal = 1e-5) "Deflection of the bristles";
protected
  SI.Force g(nominal = 100) "Friction force of slow steady sliding";
  SI.Force F_c(nominal = 100) "Coulomb friction";
  SI.Velocity z_dot(nominal = 0.1) "Rate of the deflection";
equation
  assert(F_0 > 0 and k_c >= 0 and k_st >= 1, "The Coulomb friction must be positive, k_st at least 1");
  assert(sigma_0 > 0, "The stiffness sigma_0 must be positive");
  v = der(flange.s);
  F_c = F_0 + k_c*(max(p_1, 0) + max(p_2, 0));
  g = F_c*(1 + (k_st - 1)*exp(-(v/v_s)^2));
  z_dot = v - sqrt(v*v + (v_s*1e-6)^2)*sigma_0*z/g;
  der(z) = z_dot;
  f = sigma_0*z + sigma_1*exp(-(v/v_d)^2)*z_dot + B*v;
  annotation(Documentation(info = "<html><p><code>dz/dt = v - |v| sigma_0 z/g(v)</code>, <code>f = sigma_0 z + sigma_1 exp(-(v/v_d)^2) dz/dt + B v</code>; the fading damping keeps it passive.
Source: C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, IEEE Trans. Automat. Contr. 40 (1995) 419. Valid for holds of hours: a load near the limit creeps by some 20 um an hour.</p></html>"));
end LuGre;
