within Hydraulic;
model PilotCheckValve "Pilot-operated check valve: free from a to b, both ways while the pilot holds it open"
  extends Bases.TwoPort;
  Interfaces.HydraulicPort port_x "Pilot; takes no flow";
  parameter SI.Pressure p_crack(min = 0, max = 5e6, nominal = 1e5) = 0.3e5 "Opening pressure drop at which it begins to open";
  parameter SI.Pressure p_open(min = 0, max = 1e7, nominal = 1e5) = 1.5e5 "Opening pressure drop at which it is open";
  parameter Real k_p(unit = "1", min = 1, max = 20) = 3.5 "Area of the pilot piston over that of the seat";
  parameter SI.Area A_max(min = 1e-10, max = 1e-2, nominal = 1e-5, displayUnit = "mm2") = 1e-5 "Cross section when open";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-3) = 5e-3 "Time constant of the opening";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  Real x(unit = "1", start = 0, fixed = true) "Opening, 0 to 1";
  SI.Pressure p_control(nominal = 1e6) "Pressure that opens the valve";
equation
  assert(p_open > p_crack, "p_open must lie above p_crack");
  assert(k_p >= 1 and tau > 0, "k_p must be at least 1, tau positive");
  p_control = dp + k_p*max(port_x.p - port_a.p, 0);
  tau*der(x) = Smooth.step((p_control - p_crack)/(p_open - p_crack)) - x;
  q = Functions.orificeFlow(dp, A_leak + max(x, 0)*A_max, C_d, rho, mu_in, Re_cr);
  port_x.q = 0;
  annotation(Documentation(info = "<html><p>Opens where <code>(p_a - p_b) + k_p (p_x - p_a)</code> passes <code>p_crack</code>; the pilot chamber drains to a. The pilot takes no oil, mass of poppet and pilot piston are left out: valid for changes slower than some <code>1/tau</code>. Source: pilot-operated check valve in MathWorks' Simscape documentation; the ratio 3.5 is the default of Hopsan.</p></html>"));
end PilotCheckValve;
