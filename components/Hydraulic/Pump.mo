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
  parameter Boolean sticking = false "true: the dry friction holds the shaft at rest; false: it is smooth, and a loaded shaft creeps" annotation(Evaluate = true);
  parameter SI.Torque T_s(min = 0, max = 1e3, nominal = 1) = T_c "Dry friction independent of pressure at breakaway, at least T_c, where it sticks";
  parameter SI.AngularVelocity w_st(min = 1e-3, max = 1e3, nominal = 10) = 20 "Speed over which it falls from T_s to T_c (Stribeck)";
  parameter SI.Angle phi_s(min = 1e-6, max = 0.1, nominal = 1e-3) = 5e-4 "Angle by which a shaft that sticks gives before it breaks away at 100 bar";
  Mechanical.Rotational.Bases.Bristles dry(sticking = sticking, w_s = w_s, phi_s = phi_s, hold_0 = max(T_s + k_p*D*1e7, 1e-9)) "Its sign";
equation
  assert(G >= 0 and Q_0 >= 0 and sigma >= 0, "Leakages must not be negative");
  assert(T_c >= 0 and k_p >= 0 and b >= 0, "Friction must not be negative");
  assert(T_s >= T_c, "The dry friction at breakaway T_s must not lie below T_c");
  Q_leak = thin*(G*dp + Q_0*Smooth.sgn(dp, p_Q0)) + sigma*n_abs*Smooth.sgn(dp, 2e4);
  dry.w = w;
  dry.hold = T_c + (if sticking then (T_s - T_c)*exp(-(w/w_st)^2) else 0) + k_p*D*Smooth.mag(dp, 1e4);
  T_loss = dry.hold*dry.s + b*w;
  annotation(Documentation(info = "<html>
<p>Delivery as in <code>Bases.Machine</code>.</p>
<p><b>Leakage</b> from the high to the low side: <code>mu_G/mu (G dp + Q_0 tanh(dp/p_Q0)) + sigma |n| tanh(dp/2e4 Pa)</code>: laminar gaps, an offset measured on real pumps, and oil dragged through gaps by the
motion. Any leakage takes energy in all four quadrants.</p>
<p><b>Torque</b> <code>T_sh = D dp + (T_c + k_p D |dp|) sign(w) + b w</code>, the sign rounded over <code>w_s</code>: a loaded shaft creeps within it. With <code>sticking</code> the dry part holds the shaft up to <code>T_s + k_p D |dp|</code>, by bristles that give by some 1e-4 rad (<code>Mechanical.Rotational.Bases.Bristles</code>), and falls to <code>T_c + k_p D |dp|</code> as <code>exp(-(w/w_st)^2)</code> (Stribeck). A
<code>Mechanical.Rotational.BearingFriction</code> on the same shaft adds to what holds.</p>
<p>Sources: leakages: Zhang et al., Processes 2021, 9, 814, section 4.2; torque: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001. Valid for machines with many chambers where ripple does not matter.</p></html>"));
end Pump;
