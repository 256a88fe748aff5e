within Hydraulic;
model GearPump "External gear pump: one direction of high pressure, leakage over the tooth tips with drag"
  extends Bases.Machine(deadVolume = 0.05);
  parameter Real G(unit = "m3/(s.Pa)", min = 0, max = 1e-8, nominal = 1e-12) = 2e-12 "Conductance of the internal leakage at mu_G";
  parameter SI.Length width(min = 1e-4, max = 1, nominal = 1e-2) = 0.02 "Width of the gears";
  parameter SI.Radius r_tip(min = 1e-4, max = 1, nominal = 1e-2) = 0.02 "Radius of the tooth tips";
  parameter SI.Length h_tip(min = 0, max = 1e-3, nominal = 1e-5) = 15e-6 "Gap between tooth tips and housing";
  parameter Real k_p(unit = "1", min = 0, max = 0.5) = 0.08 "Dry friction over the ideal torque";
  parameter SI.RotationalDampingConstant b(min = 0, max = 10, nominal = 1e-3) = 1e-3 "Viscous friction, at tips and side plates";
  parameter SI.AngularVelocity w_s(min = 1e-3, max = 100, nominal = 1) = 1 "Width of the sign of speed in the dry friction";
protected
  parameter Real D_drag(unit = "m3/rad") = width*h_tip*r_tip "Oil that the tips of both gears drag along, per radian";
equation
  assert(G >= 0 and k_p >= 0 and b >= 0, "Losses must not be negative");
  assert(h_tip >= 0, "The gap h_tip must not be negative");
  Q_leak = thin*G*dp - fill*D_drag*2*pi*(max(n, 0)*full_b + min(n, 0)*full_a);
  T_loss = fill*D_drag*dp + k_p*D*Smooth.mag(dp, 1e4)*Smooth.sgn(w, w_s) + b*w;
  annotation(Documentation(info = "<html><p>Fixed displacement; the dead volume is small. Delivery, compression and starvation as in <code>Bases.Machine</code>, ripple is left out.</p>
<p><b>Leakage</b> <code>mu_G/mu G dp - D_drag w</code>: oil driven back by the pressure through tip gaps and side plates, less the oil that the tips drag along to the high side. Between a tip of speed <code>r_tip w</code> and the housing the velocity falls in a straight line to zero, half of it on the mean: <code>width h_tip r_tip w/2</code> for each of the two gears.</p>
<p><b>Torque</b> <code>T_loss = D_drag dp + k_p D |dp| sign(w) + b w</code>: what drags oil against the pressure takes the torque for it, so that the drag by itself neither loses nor gives energy; the shear that it costs is in <code>b</code>. The sign is rounded over <code>w_s</code>.</p>
<p>Sources: plane Couette and Poiseuille flow added, F. M. White, Viscous Fluid Flow, 2nd ed. 1991, section 3-2; losses of gear pumps: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001.</p></html>"));
end GearPump;
