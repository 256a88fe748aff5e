within Hydraulic;
model PilotClosedCheckValve "Check valve that a pilot closes: free from a to b while the pilot is without pressure"
  extends Bases.TwoPort;
  Interfaces.HydraulicPort port_x "Pilot; takes no flow";
  parameter SI.Pressure p_crack(min = 0, max = 5e6, nominal = 1e5) = 0.5e5 "Pressure drop at which it begins to open without pilot";
  parameter SI.Pressure p_open(min = 0, max = 1e7, nominal = 1e5) = 1.5e5 "Pressure drop at which it is open without pilot";
  parameter Real k_p(unit = "1", min = 0.1, max = 20) = 1.5 "Area of the pilot piston over that of the seat";
  parameter SI.Area A_max(min = 1e-10, max = 1e-2, nominal = 1e-5, displayUnit = "mm2") = 1e-5 "Cross section when open";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-3) = 5e-3 "Time constant of the opening";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  Real x(unit = "1", start = 0, fixed = true) "Opening, 0 to 1";
  SI.Pressure p_control(nominal = 1e6) "Pressure that opens the valve";
equation
  assert(p_open > p_crack, "p_open must lie above p_crack");
  assert(k_p > 0 and tau > 0, "k_p and tau must be positive");
  assert(A_max > 0 and A_leak > 0, "The cross sections A_max and A_leak must be positive");
  p_control = dp - k_p*max(port_x.p - port_b.p, 0);
  tau*der(x) = Smooth.step((p_control - p_crack)/(p_open - p_crack)) - x;
  q = Functions.orificeFlow(dp, A_leak + max(x, 0)*A_max, C_d, rho, mu_in, Re_cr);
  port_x.q = 0;
  annotation(Documentation(info = "<html><p>Opens where <code>(p_a - p_b) - k_p (p_x - p_b)</code> passes <code>p_crack</code>; the pilot piston has b on its other side, and a pilot below b does nothing. From b to a it is closed always. With <code>p_x</code> at <code>p_a</code> and a ratio of 1 or more it stays closed whatever a does: the way to shut off a branch and to unload an accumulator.</p>
<p>The pilot takes no oil; mass and flow force of the poppet are left out: valid for changes slower than some <code>1/tau</code>. Source: balance of the forces on poppet and pilot piston, as for <code>PilotCheckValve</code>; symbol: ISO 1219-1. The values are assumed.</p></html>"));
end PilotClosedCheckValve;
