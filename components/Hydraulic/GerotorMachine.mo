within Hydraulic;
model GerotorMachine "Gerotor pump or motor: inner and outer rotor, losses from the gaps"
  extends Bases.Machine(deadVolume = 0.05, final followViscosity = true);
  parameter Integer z(min = 3, max = 20) = 6 "Teeth of the inner rotor; the outer has one more";
  parameter SI.Length width(min = 1e-3, max = 1, nominal = 1e-2) = 0.015 "Width of the rotors";
  parameter SI.Radius r_o(min = 1e-3, max = 1, nominal = 1e-2) = 0.03 "Radius of the outer rotor, at its bearing in the housing";
  parameter SI.Length h_r(min = 1e-6, max = 1e-3, nominal = 1e-5) = 60e-6 "Radial gap of the outer rotor in the housing";
  parameter SI.Length h_s(min = 1e-6, max = 1e-3, nominal = 1e-5) = 25e-6 "Gap at each side plate";
  parameter SI.Length h_t(min = 1e-7, max = 1e-3, nominal = 1e-5) = 8e-6 "Gap between the teeth that part the ports";
  parameter Real land(unit = "1", min = 0.1, max = 50) = 3 "Width over length of the lands between the ports at a side plate, both lands together";
  parameter Real k_p(unit = "1", min = 0, max = 0.5) = 0.08 "Dry friction of teeth and bearing over the ideal torque";
  parameter SI.Torque T_c(min = 0, max = 1e3, nominal = 0.1) = 0.05 "Dry friction independent of pressure";
  parameter SI.AngularVelocity w_s(min = 1e-3, max = 100, nominal = 1) = 1 "Width of the sign of speed in the dry friction";
  SI.VolumeFlowRate Q_side(nominal = 1e-6) "Leakage at the side plates";
  SI.VolumeFlowRate Q_tooth(nominal = 1e-6) "Leakage between the teeth";
protected
  Real b_visc(unit = "N.m.s/rad", nominal = 1e-3) "Viscous friction of bearing and side plates";
equation
  assert(h_r > 0 and h_s > 0 and h_t > 0, "The gaps must be positive");
  assert(k_p >= 0 and T_c >= 0, "Friction must not be negative");
  Q_side = 2*land*h_s^3/(12*mu)*dp;
  Q_tooth = Functions.orificeFlow(dp, width*h_t, 0.65, rho_high, mu);
  Q_leak = Q_side + Q_tooth;
  b_visc = mu*(z/(z + 1))^2*(2*pi*r_o^3*width/h_r + pi*r_o^4/h_s);
  T_loss = (T_c + k_p*D*Smooth.mag(dp, 1e4))*Smooth.sgn(w, w_s) + b_visc*w;
  annotation(Documentation(info = "<html><p>Delivery, compression and starvation as in <code>Bases.Machine</code>, V per revolution of the inner rotor; ripple is left out.</p>
<p><b>Leakage</b>: <code>Q_side = 2 land h_s^3/(12 mu) dp</code>, plane gaps at both side plates; <code>Q_tooth</code>, an orifice of the cross section <code>width h_t</code> where teeth part the ports: the contact is short, so that inertia counts.</p>
<p><b>Torque</b> <code>T_loss = (T_c + k_p D |dp|) sign(w) + mu (z/(z+1))^2 (2 pi r_o^3 width/h_r + pi r_o^4/h_s) w</code>: the outer rotor turns <code>z/(z + 1)</code> times as fast as the shaft, in a journal bearing and between two discs; the inner rotor counts as part of these discs. The sign is rounded over <code>w_s</code>.</p>
<p>Each loss takes energy in all four quadrants. The gaps do not change with pressure: valid up to some 100 bar. Sources: plane flow between plates, F. M. White, Viscous Fluid Flow, 2nd ed. 1991, section 3-2; bearing: N. Petroff's formula, B. J. Hamrock, Fundamentals of Fluid Film Lubrication, 1994. The values are assumed.</p></html>"));
end GerotorMachine;
