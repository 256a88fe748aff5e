within Hydraulic;
model CartridgeValve "Two-way cartridge valve (logic element): a poppet between A and B, held shut by the pressure at X"
  Interfaces.HydraulicPort port_a(dT_outflow = if oil.thermal then inStream(port_b.dT_outflow) + oil.throttling(port_b.p) - oil.throttling(port_a.p) else 0) "Port A, below the seat";
  Interfaces.HydraulicPort port_b(dT_outflow = if oil.thermal then inStream(port_a.dT_outflow) + oil.throttling(port_a.p) - oil.throttling(port_b.p) else 0) "Port B, around the poppet";
  Interfaces.HydraulicPort port_x(dT_outflow = if oil.thermal then inStream(port_x.dT_outflow) else 0) "Pilot; takes the oil that the poppet displaces";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter SI.Diameter d(min = 1e-3, max = 0.3, nominal = 1e-2) = 16e-3 "Diameter of the seat";
  parameter Real ratio(unit = "1", min = 1, max = 3) = 1.5 "Area at X over area at A; 1: B does not act on the poppet";
  parameter SI.Pressure p_crack(min = 0, max = 2e6, nominal = 1e5) = 2e5 "Pressure at A against the spring alone at which it begins to open";
  parameter SI.Pressure p_open(min = 1e3, max = 5e6, nominal = 1e5) = 4e5 "Pressure at A against the spring alone that holds it open";
  parameter SI.Length x_max(min = 1e-5, max = 0.1, nominal = 1e-3) = 4e-3 "Greatest lift";
  parameter SI.Angle alpha(min = 0.1, max = 1.5) = 45*Modelica.Constants.pi/180 "Half angle of the cone";
  parameter SI.Diameter d_x(min = 1e-4, max = 0.02, nominal = 1e-3) = 1.2e-3 "Diameter of the throttle in the pilot line, which sets how fast it opens and closes";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  SI.Length x(start = 0, fixed = true, nominal = 1e-3) "Lift";
  SI.Velocity v(nominal = 0.1) "Velocity of the poppet";
  SI.Pressure dp(nominal = 1e6) "Pressure drop from A to B";
  SI.VolumeFlowRate q(nominal = 1e-4) "Volume flow from A to B at the density rho";
  SI.Pressure p_spring(nominal = 1e6) "Pressure in the chamber of the spring";
  SI.Power lossPower(nominal = 10) "Power lost at the seat";
protected
  constant Real pi = Modelica.Constants.pi;
  parameter SI.Area A_A = pi*d^2/4 "Area at A";
  parameter SI.Area A_X = ratio*A_A "Area at X";
  parameter SI.Area A_B = A_X - A_A "Area at B";
  parameter SI.TranslationalSpringConstant k_s = 1e4*A_A*p_open/x_max "Stiffness of seat and stop";
  SI.Area A(nominal = 1e-4) "Cross section at the seat";
  SI.Force F(nominal = 100) "Spring, flow force and stops, closing";
  SI.Density rho_a(nominal = 1000) "Density at A";
  SI.Density rho_b(nominal = 1000) "Density at B";
  SI.Density rho_x(nominal = 1000) "Density at X";
  SI.MassFlowRate m_a(nominal = 1e-2) "What the poppet draws at A as it lifts";
  SI.MassFlowRate m_b(nominal = 1e-2) "The same at B";
  SI.SpecificEnthalpy w_void(nominal = 1e3) "What the voids of a add to the work of the pressure drop, less those of b";
  SI.Density rho(nominal = 1000) "Density of what flows, as in Bases.TwoPort";
  Real full(unit = "1") "Density upstream over that of the oil between its voids: 1 where it has none";
  SI.Temperature T_in(nominal = 300) "Temperature of the oil that comes in";
  SI.DynamicViscosity mu_in(nominal = 0.03) "Its viscosity at low pressure";
equation
  assert(p_open > p_crack, "p_open must lie above p_crack");
  dp = port_a.p - port_b.p;
  rho_a = oil.density(port_a.p);
  rho_b = oil.density(port_b.p);
  rho_x = oil.density(port_x.p);
  full = Smooth.blend(dp, 1e3, min(rho_a/oil.rho_l, 1), min(rho_b/oil.rho_l, 1));
  if oil.thermal then
    T_in = oil.T_0 + Smooth.blend(dp, 1e3, inStream(port_a.dT_outflow), inStream(port_b.dT_outflow));
    mu_in = oil.viscosity(T_in);
    rho = (max(rho_a, oil.rho_l) + max(rho_b, oil.rho_l))/2*full/oil.growth(T_in);
  else
    T_in = oil.T;
    mu_in = oil.mu;
    rho = (max(rho_a, oil.rho_l) + max(rho_b, oil.rho_l))/2*full;
  end if;
  A = pi*d*sin(alpha)*x_max*Smooth.ramp(min(x/x_max, 1), 0.01);
  q = Functions.orificeFlow(dp, A_leak + A, C_d, rho, mu_in, Re_cr);
  F = A_A*(p_crack + (p_open - p_crack)*x/x_max) + 2*C_d*cos(alpha)*A*Smooth.mag(dp, 1e4) + k_s*(max(x - x_max, 0) + min(x, 0));
  A_A*port_a.p + A_B*port_b.p = A_X*p_spring + F;
  v = der(x);
  A_X*v = Functions.orificeFlow(p_spring - port_x.p, pi*d_x^2/4, C_d, rho_x, mu_in, Re_cr);
  m_a = rho_x*A_A*(max(v, 0)*min(rho_a/oil.rho_l, 1) + min(v, 0));
  m_b = rho_x*A_B*(max(v, 0)*min(rho_b/oil.rho_l, 1) + min(v, 0));
  rho_a*port_a.q = rho*q + m_a;
  rho_b*port_b.q = -rho*q + m_b;
  rho_x*port_x.q = -m_a - m_b;
  w_void = oil.voidWork(port_a.p) - oil.voidWork(port_b.p);
  lossPower = dp*q*full + rho*q*w_void;
  annotation(Documentation(info = "<html>
<p>Balance of the poppet <code>p_A A_A + p_B A_B = p_spring A_X + F_0 + c x + F_flow</code>, <code>A_B = (ratio - 1) A_A</code>; cross section <code>pi d sin(alpha) x</code>, flow force <code>2 C_d cos(alpha) A |dp|</code>, closing. The poppet has no mass: what it displaces must pass the throttle <code>d_x</code> to X, <code>A_X dx/dt = q_x(p_spring - p_X)</code>, and that takes far longer than its mass would.</p>
<p>What joins X makes the function: A or B a check valve, a way valve between pressure and tank a switch, a small relief valve behind a throttle a pressure valve. <code>ratio</code> 1 to 1.1 for pressure valves, 1.5 to 2 where oil also passes from B to A.</p>
<p>The oil displaced counts at the density of X at all three ports, so that its mass is kept; where A or B has voids, as much less is drawn there. Sources: ISO 7368 (sizes); H. E. Merritt, Hydraulic Control Systems, Wiley 1967, sections 5.6 and 9.2; the values are assumed for size 16.</p></html>"));
end CartridgeValve;
