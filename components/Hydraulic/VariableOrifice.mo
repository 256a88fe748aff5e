within Hydraulic;
model VariableOrifice "Orifice whose cross section follows a signal"
  extends Bases.TwoPort;
  parameter SI.Area A_max(min = 1e-14, max = 1e-2, nominal = 1e-6, displayUnit = "mm2") = 1e-5 "Cross section at u = 1";
  parameter SI.Area A_leak(min = 1e-16, max = 1e-4, nominal = 1e-10) = 1e-10 "Cross section at u = 0";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  Interfaces.RealInput u "Opening, 0 to 1";
  SI.Area A(nominal = 1e-6) "Cross section";
equation
  assert(A_max > 0 and A_leak > 0, "The cross sections A_max and A_leak must be positive");
  A = A_leak + A_max*min(max(u, 0), 1);
  q = Functions.orificeFlow(dp, A, C_d, rho, mu_in, Re_cr);
  annotation(Documentation(info = "<html><p><code>A = A_leak + A_max u</code>, u limited to 0 to 1; flow as in <code>Orifice</code>: a throttle turned by hand, or the last stage of a valve whose opening is known.</p></html>"));
end VariableOrifice;
