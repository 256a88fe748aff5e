within Hydraulic;
model CheckValve "Check valve, static: free from a to b"
  extends Bases.TwoPort;
  parameter SI.Pressure p_crack(min = 0, max = 5e6, nominal = 1e5) = 0.3e5 "Pressure drop at which it begins to open";
  parameter SI.Pressure p_open(min = 0, max = 1e7, nominal = 1e5) = 1.5e5 "Pressure drop at which it is open";
  parameter SI.Area A_max(min = 1e-10, max = 1e-2, nominal = 1e-5, displayUnit = "mm2") = 1e-5 "Cross section when open";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  Real x(unit = "1") "Opening, 0 to 1";
equation
  assert(p_open > p_crack, "p_open must lie above p_crack");
  assert(A_max > 0 and A_leak > 0, "The cross sections A_max and A_leak must be positive");
  x = Smooth.step((dp - p_crack)/(p_open - p_crack));
  q = Functions.orificeFlow(dp, A_leak + x*A_max, C_d, rho, mu_in, Re_cr);
  annotation(Documentation(info = "<html>
<p>The cross section grows smoothly from <code>A_leak</code> to <code>A_max</code> between <code>p_crack</code> and <code>p_open</code>. No event, no mass of the poppet: use it
where the valve is faster than the circuit, <code>CheckValveDynamic</code> where it may flutter. Source: form of the check valve in MathWorks' Simscape documentation; the flow is that of <code>Orifice</code>.</p></html>"));
end CheckValve;
