within Hydraulic;
model CheckValveDynamic "Check valve whose opening follows with a time constant: free from a to b"
  extends Bases.TwoPort;
  parameter SI.Pressure p_crack(min = 0, max = 5e6, nominal = 1e5) = 0.3e5 "Pressure drop at which it begins to open";
  parameter SI.Pressure p_open(min = 0, max = 1e7, nominal = 1e5) = 1.5e5 "Pressure drop at which it is open";
  parameter SI.Area A_max(min = 1e-10, max = 1e-2, nominal = 1e-5, displayUnit = "mm2") = 1e-5 "Cross section when open";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-3) = 2e-3 "Time constant of the poppet";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  Real x(unit = "1", start = 0, fixed = true) "Opening, 0 to 1";
equation
  assert(p_open > p_crack, "p_open must lie above p_crack");
  assert(tau > 0, "The time constant tau must be positive");
  tau*der(x) = Smooth.step((dp - p_crack)/(p_open - p_crack)) - x;
  q = Functions.orificeFlow(dp, A_leak + max(x, 0)*A_max, C_d, rho, mu_in, Re_cr);
  annotation(Documentation(info = "<html><p>As <code>CheckValve</code>, the opening behind a lag: it still lets oil back for some milliseconds after the flow has turned. Naive forms: <code>CheckValve</code>, <code>CheckValveLinear</code>. Valid for motions slower than some <code>1/tau</code>: the mass of the poppet and its bouncing are left out.</p></html>"));
end CheckValveDynamic;
