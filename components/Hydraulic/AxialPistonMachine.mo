within Hydraulic;
model AxialPistonMachine "Axial piston machine with the gaps of slippers, pistons and valve plate"
  extends Bases.Machine(
    final V = 2*z*A_p*R*tan(beta_s),
    final followViscosity = true,
    deadVolume = 0.5,
    m_out_a = if useCasePort then (rho_a + rho_case)/2*G_case*(port_a.p - p_case) - m_drag else 0,
    m_out_b = if useCasePort then (rho_b + rho_case)/2*G_case*(port_b.p - p_case) + m_drag else 0,
    H_case = if oil.thermal and useCasePort then oil.c_p*rho_case*(max(-Q_case, 0)*(inStream(port_case.dT_outflow) - port_case.dT_outflow) - Q_case*oil.throttling(p_case)) else 0,
    casePower = if useCasePort then (if oil.thermal then growth else 1)*rho_case*Q_case*(2*(p_case - port_b.p)/(rho_case + max(rho_b, oil.rho_l)) - w_b) else 0);
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
  parameter Boolean sticking = false "true: the dry friction holds the shaft at rest; false: it is smooth, and a loaded shaft creeps" annotation(Evaluate = true);
  parameter SI.Angle phi_s(min = 1e-6, max = 0.1, nominal = 1e-3) = 5e-4 "Angle by which a shaft that sticks gives before it breaks away at 100 bar";
  replaceable function pistonShare = MixedFriction.constantShare constrainedby MixedFriction.Law "Share of fluid friction at the pistons, w_p being given";
  replaceable function plateShare = MixedFriction.constantShare constrainedby MixedFriction.Law "Share of fluid friction at the valve plate, w_v being given";
  parameter Boolean orificeFed = false "true: an orifice in each piston feeds the pocket of its slipper" annotation(Evaluate = true);
  parameter SI.Diameter d_o(min = 1e-4, max = 1e-2, nominal = 1e-3) = 1e-3 "Diameter of that orifice";
  parameter SI.Length l_o(min = 1e-4, max = 0.1, nominal = 1e-3) = 5e-3 "Its length";
  parameter Real drag(unit = "1", min = 0, max = 1) = 0 "Share of the oil in half the bore gaps that the pistons drag along: 0 none, 1 all of it (Couette)";
  parameter Boolean useCasePort = false "true: slippers, pistons and the outer land leak to the case" annotation(Evaluate = true);
  Interfaces.HydraulicPort port_case(p = p_case, q = -Q_case, dT_outflow = if oil.thermal then T_case - oil.T_0 else 0) if useCasePort "Case";
  SI.Pressure p_case(nominal = 1e5) "Pressure in the case";
  SI.VolumeFlowRate Q_case(nominal = 1e-6) "Leakage to the case";
  SI.VolumeFlowRate Q_slipper(nominal = 1e-6) "Leakage of the slippers";
  SI.VolumeFlowRate Q_piston(nominal = 1e-6) "Leakage of the pistons";
  SI.VolumeFlowRate Q_plate(nominal = 1e-6) "Leakage of the valve plate";
  SI.Torque T_slipper "Friction torque of the slippers";
  SI.Torque T_piston "Friction torque of the pistons";
  SI.Torque T_plate "Friction torque of the valve plate";
  SI.Torque T_rest "Friction torque of bearings and churning";
  Mechanical.Rotational.Bases.Bristles dry(
    sticking = sticking, w_s = w_s, phi_s = phi_s,
    hold_0 = max((1 - w_p)*mu_p*c_g*tan(beta_s)*D*1e7 + (1 - w_v)*mu_v*r_m*(F_s + xi*z/2*A_p*1e7) + k_b*D*1e7, 1e-9)) "Sign of the dry friction";
protected
  parameter SI.Area A_p = pi*d^2/4 "Area of a piston";
  parameter SI.Radius r_m = (r_v1 + r_v4)/2 "Mean radius of the valve plate";
  parameter Real feed(unit = "1") = if orificeFed then 1/(1 + 128*l_o*h_s^3/(6*d_o^4*log(r_s2/r_s1))) else 1 "Pressure in the pocket of a slipper over that of its chamber";
  parameter Real D_drag(unit = "m3/rad") = drag*z*d*h_p*R*tan(beta_s)/2 "Oil that the pistons drag along, per radian";
  SI.MassFlowRate m_drag(nominal = 1e-3) "Its mass flow, from B to A";
  Real G_case(unit = "m3/(s.Pa)", nominal = 1e-12) "Conductance from a port to the case";
  SI.Pressure dp_out(nominal = 1e6) "Pressure over the gaps that lead to the case, of both sides";
  SI.Density rho_case(nominal = 1000) "Density in the case";
  Real share_p(unit = "1") "Share of fluid friction at the pistons";
  Real share_v(unit = "1") "Share of fluid friction at the valve plate";
  SI.Pressure p_mag(nominal = 1e6) "Magnitude of dp, rounded over 1e4 Pa";
  Real s(unit = "1") "Sign of speed, rounded, or what of the dry friction holds";
equation
  assert(r_s2 > r_s1 and r_v2 > r_v1 and r_v3 > r_v2 and r_v4 > r_v3, "The radii of the lands must grow");
  assert(h_s > 0 and h_p > 0 and h_v > 0, "The gaps must be positive");
  p_mag = Smooth.mag(dp, 1e4);
  s = dry.s;
  dry.w = w;
  dry.hold = u_used^2*(1 - share_p)*mu_p*c_g*tan(beta_s)*D*p_mag + (1 - share_v)*mu_v*r_m*(F_s + xi*z/2*A_p*p_mag) + k_b*D*p_mag;
  share_p = pistonShare(w_p, mu, w, dp);
  share_v = plateShare(w_v, mu, w, dp);
  m_drag = fill*rho_mean*D_drag*2*pi*carried;
  if useCasePort then
    rho_case = oil.density(p_case);
    dp_out = port_a.p + port_b.p - 2*p_case;
    G_case = z/2*pi*h_s^3/(6*mu*log(r_s2/r_s1))*feed + z/2*pi*d*h_p^3*(1 + 1.5*eps^2)/(12*mu*L) + alpha_k*h_v^3/(12*mu)/log(r_v4/r_v3);
    Q_plate = alpha_k*h_v^3/(12*mu)*(dp/log(r_v2/r_v1) + dp_out/log(r_v4/r_v3));
    Q_leak = alpha_k*h_v^3/(12*mu)/log(r_v2/r_v1)*dp;
  else
    p_case = oil.p_0;
    rho_case = oil.rho_0;
    dp_out = dp;
    G_case = 0;
    Q_plate = alpha_k*h_v^3/(12*mu)*(1/log(r_v2/r_v1) + 1/log(r_v4/r_v3))*dp;
    Q_leak = Q_slipper + Q_piston + Q_plate - m_drag/rho_high;
  end if;
  rho_case*Q_case = (m_out_a + m_out_b)/(if oil.thermal then growth else 1);
  Q_slipper = z/2*pi*h_s^3/(6*mu*log(r_s2/r_s1))*feed*dp_out;
  Q_piston = z/2*pi*d*h_p^3*(1 + 1.5*eps^2)/(12*mu*L)*dp_out;
  T_slipper = z*mu*pi*(r_s2^2 - r_s1^2)*R^2/h_s*w;
  T_piston = u_used^2*(share_p*z/2*mu*pi*d*L*(R*tan(beta_s))^2/h_p*w + (1 - share_p)*mu_p*c_g*tan(beta_s)*D*p_mag*s);
  T_plate = share_v*mu*pi/2*(r_v2^4 - r_v1^4 + r_v4^4 - r_v3^4)/h_v*w + (1 - share_v)*mu_v*r_m*(F_s + xi*z/2*A_p*p_mag)*s;
  T_rest = k_b*D*p_mag*s + k_w*w*noEvent(abs(w));
  T_loss = T_slipper + T_piston + T_plate + T_rest + fill*u_used*D_drag*dp;
  annotation(Documentation(info = "<html>
<p>Laminar leakage and viscous friction of the three lubricated pairs; dry friction of piston and plate weighted with <code>1 - w_p</code> and <code>1 - w_v</code>. With the displacement u the pistons move and lean less: their friction falls with the square of it. The viscosity is that of the mean film pressure, half the pressure difference above <code>p_film0</code>.
All leakage passes from port to port; with <code>useCasePort</code> slippers, pistons and the outer land of the valve plate leak from each port to <code>port_case</code>, and only its inner land from port to port. Valid for full-film gaps of 5 to 50 um.</p>
<p><b>Mixed friction</b>: the shares of fluid friction are laws, constant by default; <code>redeclare function pistonShare = MixedFriction.stribeck</code> (and <code>plateShare</code>) lets the films form with speed.</p>
<p><b>Sticking</b> (<code>sticking</code>): the dry friction of pistons, plate and bearings holds the shaft, by bristles that give by some 1e-4 rad (<code>Mechanical.Rotational.Bases.Bristles</code>); otherwise a loaded shaft creeps within <code>w_s</code>.</p>
<p><b>Orifice-fed slippers</b> (<code>orificeFed</code>): the orifice in the piston and the land of the slipper share the pressure, <code>p_pocket = p/(1 + 128 l_o h_s^3/(6 d_o^4 ln(r_s2/r_s1)))</code>; less leaks.</p>
<p><b>Dragged oil</b> (<code>drag</code>): pistons drag oil through their bores, on average <code>z d h_p R tan(beta_s)/2</code> per radian from B to A. This acts as displacement: delivery and torque both grow, and nothing is lost by it (it is counted in <code>T_loss</code>). A pump seems to leak less, a motor more.</p>
<p><b>Dead volume over the swash angle</b>: a piston's middle position stays, so that the dead volume grows by <code>A_p R (tan beta_s - u tan beta_s)</code> as the plate swings back; <code>deadVolume</code> is that at full displacement.</p>
<p>Source: structure by H.-S. Jeong, J. Mech. Sci. Technol. 21 (2007) 312, re-derived from lubrication theory; as used in DOI 10.1177/09544054221102779, whose numbers are not at hand: the defaults are assumed. Dead volume over the swash angle: P. Zaluski, Energies 15 (2022) 298.</p></html>"));
end AxialPistonMachine;
