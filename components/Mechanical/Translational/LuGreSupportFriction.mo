within Mechanical.Translational;
model LuGreSupportFriction "Dry friction of a slider against the housing by the LuGre model"
  extends Bases.Guide;
  parameter SI.TranslationalSpringConstant sigma_0(min = 1e-9) = 1e5 "Stiffness of the bristles";
  parameter SI.TranslationalDampingConstant sigma_1(min = 0) = 600 "Damping of the bristles at standstill; about 2 sqrt(sigma_0 times inertia)";
  parameter SI.Velocity v_d(min = 1e-9) = v_s/50 "Speed over which that damping fades";
  parameter Real delta(unit = "1", min = 1, max = 4) = 2 "Exponent of the Stribeck curve: 2 Gauss, 1 Tustin";
  SI.Position z(start = 0, fixed = true, nominal = 1e-5) "Deflection of the bristles";
protected
  SI.Force g "Friction of slow steady sliding";
  SI.Velocity z_dot "Rate of the deflection";
equation
  assert(f_c > 0 and sigma_0 > 0, "f_c and sigma_0 must be positive");
  g = f_c + (f_s - f_c)*exp(-(noEvent(abs(v))/v_s)^delta);
  z_dot = v - sqrt(v*v + (v_s*1e-6)^2)*sigma_0*z/g;
  der(z) = z_dot;
  f = sigma_0*z + sigma_1*exp(-(v/v_d)^2)*z_dot + d*v;
  annotation(Documentation(info = "<html><p>Source: C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, IEEE Trans. Automat. Contr. 40 (1995) 419; the damping fades with speed, which keeps it passive. Valid for motions of rigid bodies: held long it creeps, at a millionth of <code>v_s</code>.</p></html>"));
end LuGreSupportFriction;
