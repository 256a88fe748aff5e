within Hydraulic;
model GearPump "External gear pump: one direction of high pressure, leakage over the tooth tips with drag"
  extends Bases.Machine(deadVolume = 0.05);
  parameter Real G(unit = "m3/(s.Pa)", min = 0, max = 1e-8, nominal = 1e-12) = 2e-12 "Conductance of the internal leakage at mu_G";
  parameter Real k_p(unit = "1", min = 0, max = 0.5) = 0.08 "Dry friction over the ideal torque";
  parameter SI.RotationalDampingConstant b(min = 0, max = 10, nominal = 1e-3) = 1e-3 "Viscous friction";
  parameter SI.AngularVelocity w_s(min = 1e-3, max = 100, nominal = 1) = 1 "Width of the sign of speed in the dry friction";
equation
  assert(G >= 0 and k_p >= 0 and b >= 0, "Losses must not be negative");
  Q_leak = thin*G*dp;
  T_loss = k_p*D*Smooth.mag(dp, 1e4)*Smooth.sgn(w, w_s) + b*w;
  annotation(Documentation(info = "<html><p>Leakage <code>G dp</code> over tooth tips and side plates, scaled by the viscosity, friction by pressure and speed; the dead volume is small. Delivery, compression and starvation as in <code>Bases.Machine</code>. Ripple is left out. Source: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001.</p></html>"));
end GearPump;
