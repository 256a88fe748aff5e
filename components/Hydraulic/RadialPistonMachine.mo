within Hydraulic;
model RadialPistonMachine "Radial piston machine, one or several strokes a revolution: gaps of the pistons, distributor, mixed friction"
  extends Bases.Machine(final V = strokes*z*pi/4*d^2*stroke, deadVolume = 0.3);
  parameter Integer z(min = 3, max = 20) = 5 "Number of pistons";
  parameter Integer strokes(min = 1, max = 12) = 1 "Strokes of a piston in a revolution: 1 with an eccentric, the number of cams with a cam ring";
  parameter SI.Diameter d(min = 1e-3, max = 0.3, nominal = 1e-2) = 0.04 "Diameter of the pistons";
  parameter SI.Length stroke(min = 1e-3, max = 0.5, nominal = 1e-2) = 0.04 "Stroke of the pistons";
  parameter SI.Length L(min = 1e-3, max = 1, nominal = 1e-2) = 0.04 "Length of a piston in its bore";
  parameter SI.Length h_p(min = 1e-6, max = 1e-4, nominal = 1e-5) = 15e-6 "Gap around the pistons";
  parameter Real eps(unit = "1", min = 0, max = 1) = 0.7 "Eccentricity of the pistons in their bores";
  parameter Real G_v(unit = "m3/(s.Pa)", min = 0, max = 1e-8, nominal = 1e-12) = 5e-13 "Conductance of the leakage at the distributor at mu_G";
  parameter SI.Torque T_0(min = 0, max = 1e4, nominal = 1) = 3 "Dry friction independent of pressure";
  parameter Real k_p(unit = "1", min = 0, max = 0.5) = 0.04 "Dry friction over the ideal torque";
  parameter Real k_st(unit = "1", min = 1, max = 4) = 1.6 "Friction at break-away over dry friction";
  parameter SI.AngularVelocity w_st(min = 1e-2, max = 100, nominal = 1) = 2 "Speed over which that excess falls to 37 %";
  parameter SI.RotationalDampingConstant b(min = 0, max = 100, nominal = 0.1) = 0.05 "Viscous friction of bearings, distributor and churning";
  parameter SI.AngularVelocity w_s(min = 1e-3, max = 100, nominal = 0.1) = 0.1 "Width of the sign of speed in the dry friction";
  SI.VolumeFlowRate Q_piston(nominal = 1e-6) "Leakage of the pistons";
  SI.Torque T_piston(nominal = 1) "Viscous friction of the pistons";
equation
  assert(h_p > 0 and L > 0, "The gap h_p and the length L must be positive");
  assert(G_v >= 0 and T_0 >= 0 and k_p >= 0 and k_st >= 1 and b >= 0, "The losses must not be negative, k_st at least 1");
  Q_piston = z/2*pi*d*h_p^3*(1 + 1.5*eps^2)/(12*mu*L)*dp;
  Q_leak = Q_piston + thin*G_v*dp;
  T_piston = u_used^2*z*mu*pi*d*L/h_p*(strokes*stroke/2)^2/2*w;
  T_loss = (T_0 + k_p*D*Smooth.mag(dp, 1e4))*(1 + (k_st - 1)*exp(-(w/w_st)^2))*Smooth.sgn(w, w_s) + T_piston + b*w;
  annotation(Documentation(info = "<html><p>With an eccentric (<code>strokes = 1</code>) or as a cam-ring motor for low speed and high torque (<code>strokes</code> 4 to 10). <code>V = strokes z pi/4 d^2 stroke</code>. Oil fed to <code>port_b</code> turns the shaft positively.</p>
<p><b>Leakage</b>: half of the pistons stand under pressure, <code>z/2 pi d h_p^3 (1 + 1.5 eps^2)/(12 mu L) dp</code>, and the distributor, <code>mu_G/mu G_v dp</code>; all of it counts from port to port, although that of the pistons goes to the case.</p>
<p><b>Torque</b> <code>T_loss = (T_0 + k_p D |dp|)(1 + (k_st - 1) exp(-(w/w_st)^2)) sign(w) + T_piston + b w</code>. Shear in the gaps of the pistons, whose speed is a sine of amplitude <code>strokes stroke/2 w</code>: on the mean <code>T_piston = z mu pi d L/h_p (strokes stroke/2)^2/2 w</code>, with the square of the displacement u. The dry part falls as the film forms. The sign is rounded over <code>w_s</code>.</p>
<p>Each loss takes energy in all four quadrants; ripple is left out. Sources: gaps: F. M. White, Viscous Fluid Flow, 2nd ed. 1991, chapter 3; mixed friction: form after R. Stribeck, Z. VDI 46 (1902) 1341; machines: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001. The values are assumed.</p></html>"));
end RadialPistonMachine;
