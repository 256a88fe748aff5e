within Hydraulic.Bases;
partial model Machine "Displacement machine in four quadrants: delivery and torque; leakage and friction are given by who extends it"
  Interfaces.HydraulicPort port_a(dT_outflow = if oil.thermal then T_case - oil.T_0 else 0) "Port A: a pump that turns positively delivers here; oil that is fed in here turns a motor negatively";
  Interfaces.HydraulicPort port_b(dT_outflow = if oil.thermal then T_case - oil.T_0 else 0) "Port B: a pump that turns positively draws here; oil that is fed in here turns a motor positively";
  Interfaces.RotationalFlange flange "Shaft";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter SI.Volume V(min = 1e-9, max = 1e-2, nominal = 1e-5, displayUnit = "ml") = 1e-5 "Displacement per revolution";
  parameter SI.DynamicViscosity mu_G(min = 1e-4, max = 10, nominal = 0.03) = 0.04 "Viscosity at which given conductances hold";
  parameter Boolean followViscosity = true "false: given conductances are taken as they are" annotation(Evaluate = true);
  parameter Boolean compression = true "true: oil compressed in the chambers is lost for delivery" annotation(Evaluate = true);
  parameter Boolean tangentModulus = false "true: compression with the tangent modulus of the high side instead of the densities" annotation(Evaluate = true);
  parameter Real deadVolume(unit = "1", min = 0, max = 5) = 0.4 "Dead volume of the chambers over the swept volume";
  parameter Boolean starvation = true "true: delivery falls where the inlet pressure is too low" annotation(Evaluate = true);
  parameter SI.Pressure p_cav(min = 0, max = 1e6, nominal = 1e4) = 2e4 "Inlet pressure at which nothing is drawn in any more";
  parameter SI.Pressure p_fill(min = 100, max = 1e6, nominal = 1e4) = 3e4 "Inlet pressure above p_cav from which on the chambers fill";
  parameter SI.Pressure p_film0(nominal = 1e5) = oil.p_0 "Pressure above which the mean pressure of the gaps thickens the oil";
  parameter SI.AngularVelocity w_max(min = 1e-3, max = 1e5, nominal = 100) = 900 "Speed above which a warning is given: 8600 rev/min";
  parameter Boolean useInput = false "true: the displacement follows u, -1 to 1" annotation(Evaluate = true);
  parameter SI.Volume V_oil(nominal = 1e-4, displayUnit = "ml") = 4*V "Oil in the machine that has its temperature, where oil carries heat"
    annotation(Dialog(group = "Heat"));
  parameter SI.Temperature T_oil_start(min = 220, max = 420) = oil.T_0 "Temperature of that oil at the start";
  parameter Boolean useHeatPort = false "true: losses heat what is joined to heatPort, and the oil in the gaps has the temperature there" annotation(Evaluate = true);
  Interfaces.RealInput u(unit = "1") if useInput "Displacement over V";
  Interfaces.HeatPort heatPort(T = T_case, Q_flow = Q_heat) if useHeatPort "Case: heat of the losses";
  SI.AngularVelocity w(nominal = 100) "Speed of the shaft";
  SI.Temperature T_case(start = T_oil_start, fixed = oil.thermal, nominal = 300) "Temperature of the case, of the oil in the gaps, and of what leaves where oil carries heat";
  SI.Pressure dp(nominal = 1e6) "Pressure of A above B";
  SI.VolumeFlowRate Q_A(nominal = 1e-4) "Volume flow out of port A";
  SI.VolumeFlowRate Q_leak(nominal = 1e-7) "Internal leakage from A to B, at the density of the high side";
  SI.Torque T_sh(nominal = 1) "Torque that the shaft gives to the machine";
  SI.Torque T_loss(nominal = 0.1) "Part of it that is lost";
  SI.Power lossPower(nominal = 10) "Power lost: shaft power less the power that the oil takes along";
protected
  constant Real pi = Modelica.Constants.pi;
  parameter Real D(unit = "m3/rad") = V/(2*pi) "Displacement per radian";
  Interfaces.RealInput u_used(unit = "1") "Displacement over V, in use";
  Real n(unit = "Hz") "Revolutions per second";
  Real n_abs(unit = "Hz") "Its magnitude, rounded over 1e-3 rev/s";
  Real side(unit = "1") "1: A is the high side, 0: B is";
  Real fill(unit = "1") "Filling of the chambers";
  Real full_a(unit = "1") "What of the oil between the voids the machine draws at A: its density over that, and less at a tenth";
  Real full_b(unit = "1") "The same at B";
  SI.SpecificEnthalpy w_a(nominal = 1e3) "What voids at A add to the integral of dp/rho";
  SI.SpecificEnthalpy w_b(nominal = 1e3) "The same at B";
  Real carried(unit = "Hz") "Revolutions per second that carry oil, times u";
  SI.DynamicViscosity mu_case(nominal = 0.03) "Viscosity at the temperature of the case and low pressure";
  SI.DynamicViscosity mu(nominal = 0.03) "Viscosity in the gaps";
  Real thin(unit = "1") "Leakage over that at mu_G";
  SI.HeatFlowRate Q_heat(nominal = 10) "Heat that comes in through heatPort";
  SI.HeatFlowRate H_case(nominal = 10) = 0 "Heat that comes in with the oil from a case, above that of oil at T_case and p_0";
  Real growth(unit = "1") "Volume of the oil over that at T_0";
  SI.Density rho_a(nominal = 1000) "Density at A, at T_0";
  SI.Density rho_b(nominal = 1000) "Density at B, at T_0";
  SI.Density rho_high(nominal = 1000) "Density at the high side";
  SI.Density rho_mean(nominal = 1000) "Mean density of the two sides, voids left out";
  SI.Density drho(nominal = 10) "Density at A less that at B, voids left out";
  SI.MassFlowRate m_ideal(nominal = 0.1) "Mass flow from B to A by displacement";
  SI.MassFlowRate m_out_a(nominal = 1e-3) = 0 "Mass flow from A to the case; for who extends it and has one";
  SI.MassFlowRate m_out_b(nominal = 1e-3) = 0 "Mass flow from B to the case";
  SI.Power casePower(nominal = 10) = 0 "Power that leaves with the oil to the case, against the mean of the ports";
equation
  assert(V > 0, "The displacement V must be positive");
  assert(deadVolume >= 0, "The dead volume must not be negative");
  assert(fill*(if n*u_used > 0 then full_b else full_a) > 0.5 or n_abs < 0.1, "The machine runs dry: the pressure at its inlet lies below p_cav + p_fill/2. Is the inlet open, and does it turn the right way?", AssertionLevel.warning);
  assert(abs(w) < w_max, "The machine turns faster than w_max: is a speed in rev/min given where rad/s are meant?", AssertionLevel.warning);
  connect(u, u_used);
  if not useInput then
    u_used = 1;
  end if;
  w = der(flange.phi);
  dp = port_a.p - port_b.p;
  n = w/(2*pi);
  n_abs = Smooth.mag(n, 1e-3);
  rho_a = oil.density(port_a.p);
  rho_b = oil.density(port_b.p);
  side = (1 + Smooth.sgn(dp, 2e4))/2;
  rho_high = side*rho_a + (1 - side)*rho_b;
  if oil.thermal then
    growth = oil.growth(T_case);
    oil.rho_0*V_oil*oil.c_p*der(T_case) = oil.c_p*(rho_a*(max(port_a.q, 0)*(inStream(port_a.dT_outflow) - port_a.dT_outflow) + port_a.q*oil.throttling(port_a.p))
      + rho_b*(max(port_b.q, 0)*(inStream(port_b.dT_outflow) - port_b.dT_outflow) + port_b.q*oil.throttling(port_b.p))) + H_case + T_sh*w + Q_heat;
  else
    growth = 1;
  end if;
  if not useHeatPort then
    Q_heat = 0;
  elseif not oil.thermal then
    Q_heat = -lossPower;
  end if;
  if oil.thermal or useHeatPort then
    mu_case = oil.viscosity(T_case);
  else
    T_case = oil.T;
    mu_case = oil.mu;
  end if;
  mu = oil.thickening(mu_case, (port_a.p + port_b.p)/2 - p_film0);
  thin = if followViscosity then mu_G/mu else 1;
  if starvation then
    fill = Smooth.step(((port_a.p + port_b.p)/2 - Smooth.sgn(n*u_used, 1e-2)*dp/2 - p_cav)/p_fill);
  else
    fill = 1;
  end if;
  full_a = min(rho_a/oil.rho_l, 1)*Smooth.step(10*rho_a/oil.rho_l);
  full_b = min(rho_b/oil.rho_l, 1)*Smooth.step(10*rho_b/oil.rho_l);
  carried = max(n*u_used, 0)*full_b + min(n*u_used, 0)*full_a;
  if tangentModulus then
    drho = rho_high*dp/Functions.modulus(max(port_a.p, port_b.p), oil.p_0, oil.beta_0, oil.m, oil.alpha_0*oil.x_u, oil.n_g);
    rho_mean = rho_high - (2*side - 1)*drho/2;
  else
    drho = max(rho_a, oil.rho_l) - max(rho_b, oil.rho_l);
    rho_mean = (max(rho_a, oil.rho_l) + max(rho_b, oil.rho_l))/2;
  end if;
  if compression then
    m_ideal = fill*V*(carried*rho_mean - full_a*full_b*n_abs*(0.5 + deadVolume)*drho);
  else
    m_ideal = fill*V*carried*rho_high;
  end if;
  rho_a*Q_A = (m_ideal - rho_high*Q_leak - m_out_a)/(if oil.thermal then growth else 1);
  port_a.q = -Q_A;
  rho_a*port_a.q + rho_b*port_b.q = (m_out_a + m_out_b)/(if oil.thermal then growth else 1);
  T_sh = fill*u_used*D*dp + T_loss;
  flange.tau = T_sh;
  w_a = oil.voidWork(port_a.p);
  w_b = oil.voidWork(port_b.p);
  lossPower = T_sh*w - Q_A*(if oil.thermal then growth else 1)*rho_a*(2*dp/(max(rho_a, oil.rho_l) + max(rho_b, oil.rho_l)) + w_a - w_b) - casePower;
  annotation(Documentation(info = "<html>
<p>Positive speed pushes oil from B to A. With <code>dp = p_A - p_B</code>, dp and speed of equal sign are pumping, of opposite sign motoring; a motor is the same machine.</p>
<p><b>Delivery.</b> A chamber closes at the inlet with the density there and its dead volume returns what it holds at the outlet, so that a revolution carries the mass
<code>rho_in (V + V_d) - rho_out V_d</code>. In one formula for both directions of rotation: <code>V (n (rho_A + rho_B)/2 - |n| (1/2 + V_d/V)(rho_A - rho_B))</code>. Pumping this is the known compression loss
<code>n (V + V_d) dp/beta</code>, motoring <code>n V_d dp/beta</code>; mass is conserved exactly. Without <code>compression</code> the displacement counts at the high side.</p>
<p><b>Variable displacement</b>: u scales the displacement; half the swept volume and the dead volume together, which compression sees, do not change with it.</p>
<p><b>Starvation</b>: delivery falls smoothly between <code>p_cav + p_fill</code> and <code>p_cav</code> of inlet pressure, and the torque with it. Whatever <code>starvation</code> says and however slowly it turns, it draws nothing where only vapour is left: what it carries has the share of voids that stands at its inlet, and falls to nothing as they take more than nine tenths. Voids at the outlet do not count: oil that comes in through the other side fills the chambers.</p>
<p><b>Heat</b>: with <code>useHeatPort</code> the losses go to what is joined to <code>heatPort</code>, and leakage and friction follow the temperature there: join it to the oil (<code>Thermal.OilMass</code>), or to a heat capacity for a case of its own with a conductor to the oil. Without, the gaps have the temperature of the circuit.</p>
<p><b>Oil that carries heat</b> (<code>Oil.Fluid(thermal = true)</code>): the machine holds <code>V_oil</code> of one temperature, <code>rho V_oil c_p dT/dt = sum of m (h - h_m) + T_sh w + Q</code> over its ports, h_m being the enthalpy of its oil at the reference pressure, and what leaves has that temperature. So losses warm the oil that leaves, and compression does by <code>gamma T dp/(rho c_p)</code>, some 0.13 K per MPa. <code>heatPort</code> then
joins this oil to a housing (a conductor with a heat capacity): losses are not sent there twice.</p>
<p><b>Power lost</b>: <code>T_sh w - m_flow dp/rho_mean</code>. Brought from one side to the other without loss, oil takes <code>m_flow (h_A - h_B)</code>, h being the integral of dp/rho and <code>dp/rho_mean</code> its trapezoidal form: what valves count as lost and volumes store, so that the powers of a circuit add up. Compression costs <code>V n (1/2 + V_d/V) dp^2/beta</code>, just what opening the chambers to the ports dissipates. Without <code>compression</code> the shaft does not pay for compressing the oil, and <code>V n dp^2/(2 beta)</code> is missing in the loss.</p>
<p>Sources: J. Ivantysyn and M. Ivantysynova, Hydrostatic Pumps and Motors, 2001; compression: D. McCandlish and R. E. Dorey, Proc. IMechE B 198 (1984) 165.</p></html>"));
end Machine;
