within Hydraulic;
model Valve22 "2/2 way valve, opened by a signal"
  extends Bases.TwoPort;
  Interfaces.RealInput u "Command, 0 to 1";
  replaceable Spool.FirstOrder spool constrainedby Spool.Law "Motion of the spool";
  parameter SI.Area A_max(min = 1e-10, max = 1e-2, nominal = 1e-5, displayUnit = "mm2") = 1e-5 "Cross section when open";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-9) = 1e-9 "Cross section when closed";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
equation
  assert(A_max > 0 and A_leak > 0, "The cross sections A_max and A_leak must be positive");
  connect(u, spool.u);
  q = Functions.orificeFlow(dp, A_leak + A_max*min(max(spool.y, 0), 1), C_d, rho, mu_in, Re_cr);
  annotation(Documentation(info = "<html><p>The spool follows the command by its own law (<code>Spool</code>, replaceable), the cross section the spool; a leakage remains when closed. Flow forces are left out.</p></html>"));
end Valve22;
