within Hydraulic;
model CounterbalanceValve "Counterbalance valve: holds a load at b, opened by the load and by a pilot; free from a to b"
  extends Bases.TwoPort;
  Interfaces.HydraulicPort port_x "Pilot; takes no flow";
  parameter SI.Pressure p_set(min = 1e3, max = 1e8, nominal = 1e7) = 250e5 "Pressure at b at which it opens without pilot";
  parameter Real pilotRatio(unit = "1", min = 0, max = 20) = 4 "Area of the pilot over that of the load";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 1e-3 "Flow when fully open, at p_set*(1 + override)";
  parameter Real override(unit = "1", min = 0.005, max = 1) = 0.2 "Rise of pressure from cracking to fully open, over p_set";
  parameter SI.Pressure p_crack(min = 100, max = 5e6, nominal = 1e5) = 1e5 "Cracking pressure of the check from a to b";
  parameter SI.Area A_check(min = 1e-10, max = 1e-2, nominal = 1e-5, displayUnit = "mm2") = 1e-5 "Cross section of the open check";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-2) = 1e-2 "Time constant of the opening";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  Real x(unit = "1", start = 0, fixed = true) "Opening against the load, 0 to 1";
protected
  parameter SI.Density rho_full = (oil.density(oil.p_0) + oil.density(oil.p_0 + p_set*(1 + override)))/2 "Mean density when fully open, the outlet at p_0";
  parameter SI.Area A_max = q_nom/(C_d*sqrt(2*p_set*(1 + override)/rho_full)) "Cross section when open";
equation
  assert(p_set > 0 and q_nom > 0 and override > 0 and tau > 0, "p_set, q_nom, override and tau must be positive");
  tau*der(x) = Smooth.clip((-dp + pilotRatio*max(port_x.p - port_a.p, 0) - p_set)/(override*p_set), 0.1) - x;
  q = Functions.orificeFlow(dp, A_leak + max(x, 0)*A_max + A_check*Smooth.step((dp - p_crack)/p_crack), C_d, rho, mu_in, Re_cr);
  port_x.q = 0;
  annotation(Documentation(info = "<html><p>Holds a load: from b to a it opens with <code>p_b - p_a + pilotRatio (p_x - p_a)</code> above <code>p_set</code>, behind a lag; from a to b a check valve lets oil in. A high pilot ratio saves energy and invites oscillation. The pilot takes no oil; the lag is assumed. Source: H. Murrenhoff, Grundlagen der Fluidtechnik 1: Hydraulik, 2012.</p></html>"));
end CounterbalanceValve;
