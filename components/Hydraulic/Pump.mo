within Hydraulic;
model Pump "Displacement machine, cycle averaged: pump and motor in four quadrants, with leakage, compression and friction"
  Interfaces.HydraulicPort port_a "Port A; the high side when pumping with positive speed";
  Interfaces.HydraulicPort port_b "Port B";
  Interfaces.RotationalFlange flange "Shaft";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter SI.Volume V(min = 1e-9, max = 1e-2, nominal = 1e-5, displayUnit = "ml") = 1e-5 "Displacement per revolution";
  parameter Real G(unit = "m3/(s.Pa)", min = 0, max = 1e-8, nominal = 1e-12) = 1e-13 "Conductance of the internal leakage at mu_G";
  parameter SI.VolumeFlowRate Q_0(min = 0, max = 1e-3, nominal = 1e-7) = 0 "Leakage that does not grow with pressure, at mu_G";
  parameter SI.Pressure p_Q0(min = 1e3, max = 1e7, nominal = 1e6) = 5e5 "Pressure over which Q_0 sets in";
  parameter SI.Volume sigma(min = 0, max = 1e-3, nominal = 1e-8) = 0 "Shear leakage per revolution";
  parameter SI.DynamicViscosity mu_G(min = 1e-4, max = 10, nominal = 0.03) = 0.04 "Viscosity at which G and Q_0 hold";
  parameter Boolean followViscosity = true "false: G and Q_0 are taken as they are" annotation(Evaluate = true);
  parameter Boolean compression = true "true: oil compressed in the chambers is lost for delivery" annotation(Evaluate = true);
  parameter Real deadVolume(unit = "1", min = 0, max = 5) = 0.4 "Dead volume of the chambers over the swept volume";
  parameter Boolean starvation = true "true: delivery falls where the inlet pressure is too low" annotation(Evaluate = true);
  parameter SI.Pressure p_cav(min = 0, max = 1e6, nominal = 1e4) = 2e4 "Inlet pressure at which nothing is drawn in any more";
  parameter SI.Pressure p_fill(min = 100, max = 1e6, nominal = 1e4) = 3e4 "Inlet pressure above p_cav from which on the chambers fill";
  parameter SI.Torque T_c(min = 0, max = 1e3, nominal = 1) = 0 "Dry friction independent of pressure, smooth";
  parameter Real k_p(unit = "1", min = 0, max = 0.5) = 0.05 "Dry friction over the ideal torque";
  parameter SI.RotationalDampingConstant b(min = 0, max = 10, nominal = 1e-3) = 1e-4 "Viscous friction";
  parameter SI.AngularVelocity w_s(min = 1e-3, max = 100, nominal = 1) = 1 "Width of the sign of speed in the dry friction";
  SI.AngularVelocity w(nominal = 100) "Speed of the shaft";
  SI.Pressure dp(nominal = 1e6) "Pressure of A above B";
  SI.VolumeFlowRate Q_A(nominal = 1e-4) "Volume flow out of port A";
  SI.VolumeFlowRate Q_leak(nominal = 1e-7) "Leakage from A to B, at the density of the high side";
  SI.Torque T_sh(nominal = 1) "Torque that the shaft gives to the machine";
  SI.Torque T_loss(nominal = 0.1) "Part of it that is lost";
protected
  constant Real pi = Modelica.Constants.pi;
  parameter Real D(unit = "m3/rad") = V/(2*pi) "Displacement per radian";
  SI.Frequency n "Revolutions per second";
  Real n_abs(unit = "Hz") "Its magnitude, rounded over 1e-3 rev/s";
  Real side(unit = "1") "1: A is the high side, 0: B is";
  Real fill(unit = "1") "Filling of the chambers";
  Real thin(unit = "1") "Leakage over that at mu_G";
  SI.Density rho_a(nominal = 1000) "Density at A";
  SI.Density rho_b(nominal = 1000) "Density at B";
  SI.Density rho_high(nominal = 1000) "Density at the high side";
  SI.MassFlowRate m_ideal(nominal = 0.1) "Mass flow from B to A by displacement";
equation
  assert(V > 0, "The displacement V must be positive");
  assert(G >= 0 and Q_0 >= 0 and sigma >= 0 and deadVolume >= 0, "Leakages and dead volume must not be negative");
  w = der(flange.phi);
  dp = port_a.p - port_b.p;
  n = w/(2*pi);
  n_abs = Smooth.mag(n, 1e-3);
  rho_a = oil.density(port_a.p);
  rho_b = oil.density(port_b.p);
  side = (1 + Smooth.sgn(dp, 2e4))/2;
  rho_high = side*rho_a + (1 - side)*rho_b;
  if starvation then
    fill = Smooth.step(((port_a.p + port_b.p)/2 - Smooth.sgn(n, 1e-2)*dp/2 - p_cav)/p_fill);
  else
    fill = 1;
  end if;
  if compression then
    m_ideal = fill*V*(n*(rho_a + rho_b)/2 - n_abs*(0.5 + deadVolume)*(rho_a - rho_b));
  else
    m_ideal = fill*V*n*rho_high;
  end if;
  thin = if followViscosity then mu_G/oil.thickening(oil.mu, (port_a.p + port_b.p)/2 - oil.p_0) else 1;
  Q_leak = thin*(G*dp + Q_0*Smooth.sgn(dp, p_Q0)) + sigma*n_abs*Smooth.sgn(dp, 2e4);
  rho_a*Q_A = m_ideal - rho_high*Q_leak;
  port_a.q = -Q_A;
  rho_a*port_a.q + rho_b*port_b.q = 0;
  T_loss = (T_c + k_p*D*Smooth.mag(dp, 1e4))*Smooth.sgn(w, w_s) + b*w;
  T_sh = D*dp + T_loss;
  flange.tau = T_sh;
  annotation(Documentation(info = "<html>
<p>Positive speed pushes oil from B to A. With <code>dp = p_A - p_B</code>, dp and speed of equal sign are pumping, of opposite sign motoring; a motor is the same machine.</p>
<p><b>Delivery.</b> A chamber closes at the inlet with the density there and its dead volume returns what it holds at the outlet, so that a revolution carries the mass
<code>rho_in (V + V_d) - rho_out V_d</code>. In one formula for both directions of rotation: <code>V (n (rho_A + rho_B)/2 - |n| (1/2 + V_d/V)(rho_A - rho_B))</code>. Pumping this is the known compression loss
<code>n (V + V_d) dp/beta</code>, motoring <code>n V_d dp/beta</code>; mass is conserved exactly. Without <code>compression</code> the displacement counts at the high side.</p>
<p><b>Leakage</b> from the high to the low side: <code>mu_G/mu (G dp + Q_0 tanh(dp/p_Q0)) + sigma |n| tanh(dp/2e4 Pa)</code>: laminar gaps, an offset measured on real pumps, and oil dragged through gaps by the
motion. Any leakage takes energy in all four quadrants.</p>
<p><b>Torque</b> <code>T_sh = D dp + (T_c + k_p D |dp|) sign(w) + b w</code>, the sign rounded over <code>w_s</code>; for a shaft that must hold still set <code>T_c = 0</code> and add
<code>Mechanical.Rotational.BearingFriction</code>.</p>
<p><b>Starvation</b>: delivery falls smoothly between <code>p_cav + p_fill</code> and <code>p_cav</code> of inlet pressure.</p>
<p>Sources: leakages of pressure, shear and compression: Zhang et al., Processes 2021, 9, 814, section 4.2; torque: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001; compression: D. McCandlish and R. E. Dorey, Proc.
IMechE B 198 (1984) 165. Valid for machines with many chambers where ripple does not matter.</p></html>"));
end Pump;
