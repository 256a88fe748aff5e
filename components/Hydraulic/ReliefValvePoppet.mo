within Hydraulic;
model ReliefValvePoppet "Relief valve with the motion of its poppet and the flow force"
  extends Bases.TwoPort;
  parameter SI.Pressure p_set(min = 1e3, max = 1e8, nominal = 1e7) = 200e5 "Pressure drop at which it begins to open";
  parameter SI.Diameter d(min = 1e-4, max = 0.1, nominal = 1e-3) = 4e-3 "Diameter of the seat";
  parameter SI.Angle alpha(min = 0.05, max = 1.5) = 20*Modelica.Constants.pi/180 "Half angle of the cone";
  parameter SI.Mass m(min = 1e-6, max = 10, nominal = 1e-3) = 5e-3 "Mass of the poppet";
  parameter SI.TranslationalSpringConstant k(min = 1, max = 1e9, nominal = 1e4) = 5e4 "Spring";
  parameter Real zeta(unit = "1", min = 0.01, max = 10) = 1/3 "Damping over the critical one";
  parameter SI.Length x_max(min = 1e-6, max = 0.1, nominal = 1e-3) = 1e-3 "Greatest lift";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real C_v(unit = "1", min = 0.1, max = 1) = 0.98 "Velocity coefficient of the jet";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  SI.Length x(start = 0, fixed = true, nominal = 1e-4) "Lift";
  SI.Velocity v(start = 0, fixed = true, nominal = 0.1) "Velocity of the poppet";
  SI.Force F_flow(nominal = 1) "Flow force, closing";
protected
  constant Real pi = Modelica.Constants.pi;
  parameter SI.Area A_s = pi*d^2/4 "Area of the seat";
  parameter SI.TranslationalDampingConstant c = 2*zeta*sqrt(k*m) "Damping";
  parameter SI.Length x_w = 1e-6 "Lift over which the seat closes";
  SI.Force F_stop(nominal = 1) "Force of seat and stop";
  SI.Length lift(nominal = 1e-4) "Lift, never negative";
equation
  assert(p_set > 0 and m > 0 and k > 0, "p_set, mass m and spring k must be positive");
  lift = Smooth.pos(x, x_w);
  F_flow = 2*C_d*C_v*pi*d*sin(alpha)*cos(alpha)*lift*max(dp, 0);
  F_stop = max(-x, 0)*(1e3*k - 1e3*c*min(v, 0)/x_max) - max(x - x_max, 0)*(1e3*k + 1e3*c*max(v, 0)/x_max);
  der(x) = v;
  m*der(v) = A_s*(dp - p_set) - k*x - c*v - F_flow + F_stop;
  q = Functions.orificeFlow(dp, max(pi*d*sin(alpha)*lift, 1e-16), C_d, rho, mu_in, Re_cr);
  annotation(Documentation(info = "<html><p><code>m x'' = A_s (dp - p_set) - k x - c x' - 2 C_d C_v pi d sin a cos a x dp</code>, cross section <code>pi d sin(a) x</code>. Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, chapters 5 and 9. Valid for steady flow forces; those of accelerated oil and the recovery of pressure behind the seat are left out. Backwards it is shut.</p></html>"));
end ReliefValvePoppet;
