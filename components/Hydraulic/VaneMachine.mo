within Hydraulic;
model VaneMachine "Vane machine: friction of the vane tips by spring, centrifugal force and pressure; leakage at side plates and tips"
  extends Bases.Machine(V = 2e-5, deadVolume = 0.2);
  parameter Integer z(min = 2, max = 30) = 12 "Number of vanes";
  parameter SI.Radius R(min = 1e-3, max = 1, nominal = 1e-2) = 0.03 "Mean radius of the cam ring";
  parameter SI.Length width(min = 1e-3, max = 1, nominal = 1e-2) = 0.02 "Width of the vanes";
  parameter SI.Length t_v(min = 1e-4, max = 0.05, nominal = 1e-3) = 1.8e-3 "Thickness of the vanes";
  parameter Real unbalanced(unit = "1", min = 0, max = 1) = 0.2 "Part of the pressure force under a vane that its tip does not balance";
  parameter SI.Force F_s(min = 0, max = 1e4, nominal = 10) = 5 "Force that presses each vane to the ring without pressure and speed";
  parameter SI.Mass m_v(min = 0, max = 10, nominal = 1e-2) = 4e-3 "Mass of a vane";
  parameter Real mu_f(unit = "1", min = 0, max = 1) = 0.1 "Coefficient of dry friction at the tips";
  parameter SI.RotationalDampingConstant b(min = 0, max = 10, nominal = 1e-3) = 2e-3 "Viscous friction of rotor and shaft seal";
  parameter Real G(unit = "m3/(s.Pa)", min = 0, max = 1e-8, nominal = 1e-12) = 2e-12 "Conductance of the leakage at the side plates at mu_G";
  parameter SI.Area A_tip(min = 1e-12, max = 1e-5, nominal = 1e-8, displayUnit = "mm2") = 5e-8 "Cross section of the gaps at the tips and ends of the sealing vanes";
  parameter SI.AngularVelocity w_s(min = 1e-3, max = 100, nominal = 1) = 1 "Width of the sign of speed in the dry friction";
protected
  SI.Force F_tip(nominal = 100) "Sum of the forces of all tips on the ring";
equation
  assert(F_s >= 0 and m_v >= 0 and mu_f >= 0 and b >= 0, "The forces and the friction must not be negative");
  assert(G >= 0 and A_tip > 0, "G must not be negative, A_tip must be positive");
  F_tip = z*(F_s + m_v*R*w^2) + z/2*unbalanced*width*t_v*Smooth.mag(dp, 1e4);
  Q_leak = thin*G*dp + Functions.orificeFlow(dp, A_tip, 0.65, rho_high, mu);
  T_loss = mu_f*R*F_tip*Smooth.sgn(w, w_s) + b*w;
  annotation(Documentation(info = "<html><p>Delivery, compression, starvation and variable displacement as in <code>Bases.Machine</code>; a vane machine with balanced (double-stroke) ring has fixed displacement.</p>
<p><b>Leakage</b> <code>mu_G/mu G dp</code> through the plane gaps at the side plates, and an orifice <code>A_tip</code>, laminar at low pressure, at the tips and ends of the vanes that part the ports.</p>
<p><b>Torque</b> <code>T_loss = mu_f R (z (F_s + m_v R w^2) + z/2 unbalanced width t_v |dp|) sign(w) + b w</code>: each vane is pressed to the ring by its spring (or by the pressure that bears it), by its mass, and, on the high side, by the pressure under it, of which the tip balances all but <code>unbalanced</code>. So the friction has a part proportional to the pressure and one that stays. The sign is rounded over <code>w_s</code>; the friction at the tips does not scale with the displacement.</p>
<p>Each loss takes energy in all four quadrants. That the vanes without springs leave the ring at low speed is left out: valid above the least speed that the maker gives. Sources: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001 (vane machines); the torque follows from the balance of forces of a vane. The values are assumed.</p></html>"));
end VaneMachine;
