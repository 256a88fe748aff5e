within Hydraulic;
model Orifice "Sharp-edged orifice of constant cross section"
  extends Bases.TwoPort;
  parameter SI.Area A(min = 1e-14, max = 1e-2, nominal = 1e-6, displayUnit = "mm2") = 1e-6 "Cross section";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
equation
  assert(A > 0, "The cross section A must be positive");
  q = Functions.orificeFlow(dp, A, C_d, rho, mu_in, Re_cr);
  annotation(Documentation(info = "<html>
<p><code>q = C_d A sqrt(2 dp/rho)</code>, laminar below the Reynolds number <code>Re_cr</code>: see <code>Hydraulic.Functions.orificeFlow</code>. The same flow in both directions,
passive everywhere. For long bores and gaps use <code>LaminarGap</code>.</p></html>"));
end Orifice;
