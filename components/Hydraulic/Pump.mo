within Hydraulic;
model Pump "Displacement machine, cycle averaged: pump and motor in four quadrants, with measured leakages and friction"
  extends Bases.Machine;
  parameter Real G(unit = "m3/(s.Pa)", min = 0, max = 1e-8, nominal = 1e-12) = 1e-13 "Conductance of the internal leakage at mu_G";
  parameter SI.VolumeFlowRate Q_0(min = 0, max = 1e-3, nominal = 1e-7) = 0 "Leakage that does not grow with pressure, at mu_G";
  parameter SI.Pressure p_Q0(min = 1e3, max = 1e7, nominal = 1e6) = 5e5 "Pressure over which Q_0 sets in";
  parameter SI.Volume sigma(min = 0, max = 1e-3, nominal = 1e-8) = 0 "Shear leakage per revolution";
  parameter SI.Torque T_c(min = 0, max = 1e3, nominal = 1) = 0 "Dry friction independent of pressure, smooth";
  parameter Real k_p(unit = "1", min = 0, max = 0.5) = 0.05 "Dry friction over the ideal torque";
  parameter SI.RotationalDampingConstant b(min = 0, max = 10, nominal = 1e-3) = 1e-4 "Viscous friction";
  parameter SI.AngularVelocity w_s(min = 1e-3, max = 100, nominal = 1) = 1 "Width of the sign of speed in the dry friction";
equation
  assert(G >= 0 and Q_0 >= 0 and sigma >= 0, "Leakages must not be negative");
  assert(T_c >= 0 and k_p >= 0 and b >= 0, "Friction must not be negative");
  Q_leak = thin*(G*dp + Q_0*Smooth.sgn(dp, p_Q0)) + sigma*n_abs*Smooth.sgn(dp, 2e4);
  T_loss = (T_c + k_p*D*Smooth.mag(dp, 1e4))*Smooth.sgn(w, w_s) + b*w;
  annotation(Documentation(info = "<html>
<p>Delivery as in <code>Bases.Machine</code>.</p>
<p><b>Leakage</b> from the high to the low side: <code>mu_G/mu (G dp + Q_0 tanh(dp/p_Q0)) + sigma |n| tanh(dp/2e4 Pa)</code>: laminar gaps, an offset measured on real pumps, and oil dragged through gaps by the
motion. Any leakage takes energy in all four quadrants.</p>
<p><b>Torque</b> <code>T_sh = D dp + (T_c + k_p D |dp|) sign(w) + b w</code>, the sign rounded over <code>w_s</code>; for a shaft that must hold still set <code>T_c = 0</code> and add
<code>Mechanical.Rotational.BearingFriction</code>.</p>
<p>Sources: leakages: Zhang et al., Processes 2021, 9, 814, section 4.2; torque: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001. Valid for machines with many chambers where ripple does not matter.</p></html>"));
end Pump;
