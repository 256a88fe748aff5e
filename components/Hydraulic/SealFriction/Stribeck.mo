within Hydraulic.SealFriction;
model Stribeck "Coulomb, Stribeck and viscous friction, smooth through zero speed"
  extends Law;
  parameter SI.Force F_0(min = 0, max = 1e6, nominal = 100) = 300 "Coulomb friction without pressure";
  parameter SI.Area k_c(min = 0, max = 1, nominal = 1e-5) = 5e-5 "Coulomb friction per sum of the pressures";
  parameter Real k_st(unit = "1", min = 1, max = 5) = 1.3 "Break-away friction over Coulomb friction";
  parameter SI.Velocity v_brk(min = 1e-6, max = 1, nominal = 1e-2) = 5e-3 "Speed of the greatest friction";
  parameter SI.TranslationalDampingConstant B(min = 0, max = 1e8, nominal = 1e3) = 2000 "Viscous friction";
  SI.Velocity v(nominal = 0.1) "Velocity";
protected
  constant Real e_2 = sqrt(2*Modelica.Constants.e);
  SI.Force F_c(nominal = 100) "Coulomb friction";
  Real x(unit = "1") "Velocity over the Stribeck speed";
equation
  assert(F_0 >= 0 and k_c >= 0 and B >= 0 and k_st >= 1, "F_0, k_c and B must not be negative, k_st at least 1");
  v = der(flange.s);
  F_c = F_0 + k_c*(max(p_1, 0) + max(p_2, 0));
  x = v/(sqrt(2)*v_brk);
  f = e_2*(k_st - 1)*F_c*exp(-x*x)*x + F_c*Smooth.sgn(v, v_brk/10) + B*v;
  annotation(Documentation(info = "<html><p><code>F_c = F_0 + k_c (p_1 + p_2)</code>; <code>f = sqrt(2 e)(k_st - 1) F_c exp(-x^2) x + F_c tanh(10 v/v_brk) + B v</code>, <code>x = v/(sqrt(2) v_brk)</code>. A loaded piston creeps by up to v_brk/10; where it must hold, take <code>Sticking</code> or <code>LuGre</code>.
Source: the form of the friction elements of MathWorks' Simscape documentation, cylinder friction.</p></html>"));
end Stribeck;
