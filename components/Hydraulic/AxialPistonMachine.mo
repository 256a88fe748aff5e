within Hydraulic;
model AxialPistonMachine "Axial piston machine with the gaps of slippers, pistons and valve plate"
  extends Bases.Machine(
    final V = 2*z*A_p*R*tan(beta_s),
    final followViscosity = true,
    deadVolume = 0.5,
    starvation = false);
  parameter Integer z(min = 3, max = 15) = 9 "Number of pistons";
  parameter SI.Diameter d(min = 1e-3, max = 0.2, nominal = 1e-2) = 0.02 "Diameter of the pistons";
  parameter SI.Radius R(min = 1e-3, max = 1, nominal = 1e-2) = 0.038 "Pitch radius";
  parameter SI.Angle beta_s(min = 0.01, max = 0.8) = 18*Modelica.Constants.pi/180 "Angle of the swash plate";
  parameter SI.Length L(min = 1e-3, max = 1, nominal = 1e-2) = 0.035 "Length of a piston in its bore";
  parameter Real eps(unit = "1", min = 0, max = 1) = 0.7 "Eccentricity of the pistons";
  parameter SI.Length h_s(min = 1e-6, max = 1e-4, nominal = 1e-5) = 20e-6 "Gap under the slippers";
  parameter SI.Length h_p(min = 1e-6, max = 1e-4, nominal = 1e-5) = 24e-6 "Gap around the pistons";
  parameter SI.Length h_v(min = 1e-6, max = 1e-4, nominal = 1e-5) = 19e-6 "Gap at the valve plate";
  parameter SI.Radius r_s1(min = 1e-4) = 0.008 "Inner radius of the slipper's land";
  parameter SI.Radius r_s2(min = 1e-4) = 0.0125 "Outer radius of the slipper's land";
  parameter SI.Radius r_v1(min = 1e-4) = 0.026 "Inner land of the valve plate, inner radius";
  parameter SI.Radius r_v2(min = 1e-4) = 0.030 "Inner land, outer radius";
  parameter SI.Radius r_v3(min = 1e-4) = 0.038 "Outer land, inner radius";
  parameter SI.Radius r_v4(min = 1e-4) = 0.042 "Outer land, outer radius";
  parameter SI.Angle alpha_k(min = 0.1, max = 3.1) = 2.8 "Angle of a kidney";
  parameter Real w_p(unit = "1", min = 0, max = 1) = 0.7 "Share of fluid friction at the pistons";
  parameter Real w_v(unit = "1", min = 0, max = 1) = 0.75 "Share of fluid friction at the valve plate";
  parameter Real mu_p(unit = "1", min = 0, max = 1) = 0.12 "Coefficient of dry friction at the pistons";
  parameter Real mu_v(unit = "1", min = 0, max = 1) = 0.12 "Coefficient of dry friction at the valve plate";
  parameter Real c_g(unit = "1", min = 1, max = 5) = 1.6 "Overhang of the side force";
  parameter SI.Force F_s(min = 0, max = 1e5) = 500 "Spring that holds the barrel to the valve plate";
  parameter Real xi(unit = "1", min = 0, max = 1) = 0.06 "Residual share of the hydraulic force that holds it";
  parameter Real k_b(unit = "1", min = 0, max = 0.5) = 0.015 "Friction of the bearings over the ideal torque";
  parameter Real k_w(unit = "N.m.s2/rad2", min = 0) = 5e-6 "Churning";
  parameter SI.AngularVelocity w_s(min = 1e-3, max = 100, nominal = 1) = 1 "Width of the sign of speed in dry friction";
  SI.VolumeFlowRate Q_slipper(nominal = 1e-6) "Leakage of the slippers";
  SI.VolumeFlowRate Q_piston(nominal = 1e-6) "Leakage of the pistons";
  SI.VolumeFlowRate Q_plate(nominal = 1e-6) "Leakage of the valve plate";
  SI.Torque T_slipper "Friction torque of the slippers";
  SI.Torque T_piston "Friction torque of the pistons";
  SI.Torque T_plate "Friction torque of the valve plate";
  SI.Torque T_rest "Friction torque of bearings and churning";
protected
  parameter SI.Area A_p = pi*d^2/4 "Area of a piston";
  parameter SI.Radius r_m = (r_v1 + r_v4)/2 "Mean radius of the valve plate";
  SI.Pressure p_mag(nominal = 1e6) "Magnitude of dp, rounded over 1e4 Pa";
  Real s(unit = "1") "Sign of speed, rounded";
equation
  assert(r_s2 > r_s1 and r_v2 > r_v1 and r_v3 > r_v2 and r_v4 > r_v3, "The radii of the lands must grow");
  assert(h_s > 0 and h_p > 0 and h_v > 0, "The gaps must be positive");
  p_mag = Smooth.mag(dp, 1e4);
  s = Smooth.sgn(w, w_s);
  Q_slipper = z/2*pi*h_s^3/(6*mu*log(r_s2/r_s1))*dp;
  Q_piston = z/2*pi*d*h_p^3*(1 + 1.5*eps^2)/(12*mu*L)*dp;
  Q_plate = alpha_k*h_v^3/(12*mu)*(1/log(r_v2/r_v1) + 1/log(r_v4/r_v3))*dp;
  Q_leak = Q_slipper + Q_piston + Q_plate;
  T_slipper = z*mu*pi*(r_s2^2 - r_s1^2)*R^2/h_s*w;
  T_piston = u_used^2*(w_p*z/2*mu*pi*d*L*(R*tan(beta_s))^2/h_p*w + (1 - w_p)*mu_p*c_g*tan(beta_s)*D*p_mag*s);
  T_plate = w_v*mu*pi/2*(r_v2^4 - r_v1^4 + r_v4^4 - r_v3^4)/h_v*w + (1 - w_v)*mu_v*r_m*(F_s + xi*z/2*A_p*p_mag)*s;
  T_rest = k_b*D*p_mag*s + k_w*w*noEvent(abs(w));
  T_loss = T_slipper + T_piston + T_plate + T_rest;
  annotation(Documentation(info = "<html>
<p>Laminar leakage and viscous friction of the three lubricated pairs; dry friction of piston and plate weighted with <code>1 - w_p</code> and <code>1 - w_v</code>. With the displacement u the pistons move and lean less: their friction falls with the square of it. The viscosity is that of the mean film pressure, half the pressure difference above <code>p_film0</code>.
All leakage passes from port to port (<code>CasePump(redeclare AxialPistonMachine machine)</code> adds ways to the case); valid for full-film gaps of 5 to 50 um. The shares of fluid friction are constants: what changes between mixed and full film over speed is not in it.</p>
<p>Source: structure by H.-S. Jeong, J. Mech. Sci. Technol. 21 (2007) 312, re-derived from lubrication theory; as used in DOI 10.1177/09544054221102779, whose numbers are not at hand: the defaults are assumed.</p></html>"));
end AxialPistonMachine;
