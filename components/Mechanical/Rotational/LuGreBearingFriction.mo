within Mechanical.Rotational;
model LuGreBearingFriction "Dry friction of a shaft against the housing by the LuGre model"
  extends Bases.Guide;
  parameter SI.RotationalSpringConstant sigma_0(min = 1e-9) = 40 "Stiffness of the bristles";
  parameter SI.RotationalDampingConstant sigma_1(min = 0) = 0.17 "Damping of the bristles at standstill; about 2 sqrt(sigma_0 times inertia)";
  parameter SI.AngularVelocity w_d(min = 1e-9) = w_s/50 "Speed over which that damping fades";
  parameter Real delta(unit = "1", min = 1, max = 4) = 2 "Exponent of the Stribeck curve: 2 Gauss, 1 Tustin";
  SI.Angle z(start = 0, fixed = true, nominal = 1e-3) "Deflection of the bristles";
protected
  SI.Torque g "Friction of slow steady sliding";
  SI.AngularVelocity z_dot "Rate of the deflection";
equation
  assert(tau_c > 0 and sigma_0 > 0, "tau_c and sigma_0 must be positive");
  g = tau_c + (tau_s - tau_c)*exp(-(noEvent(abs(w))/w_s)^delta);
  z_dot = w - sqrt(w*w + (w_s*1e-6)^2)*sigma_0*z/g;
  der(z) = z_dot;
  tau = sigma_0*z + sigma_1*exp(-(w/w_d)^2)*z_dot + d*w;
  annotation(Documentation(info = "<html><p>Source: C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, IEEE Trans. Automat. Contr. 40 (1995) 419; the damping fades with speed, which keeps it passive. Valid for motions of rigid bodies: held long it creeps, at a millionth of <code>w_s</code>.</p></html>"));
end LuGreBearingFriction;
