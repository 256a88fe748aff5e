within Hydraulic;
model SpoolEdge "Metering edge of a spool"
  extends Bases.TwoPort;
  Interfaces.RealInput x "Position of the spool in the opening direction, -1 to 1";
  parameter SI.Area A_max(min = 1e-10, max = 1e-2, nominal = 1e-5, displayUnit = "mm2") = 1e-5 "Cross section at x = 1";
  parameter Real overlap(unit = "1", min = -0.5, max = 0.5) = 0 "Travel before it opens; negative: open in the middle";
  parameter Real rounding(unit = "1", min = 1e-4, max = 0.5) = 0.02 "Travel over which the edge opens smoothly";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-4 "Leakage cross section over A_max";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
equation
  assert(A_max > 0, "The cross section A_max must be positive");
  q = Functions.orificeFlow(dp, A_max*(leak + Smooth.ramp(x - overlap, rounding)/(1 - overlap)), C_d, rho, mu_in, Re_cr);
  annotation(Documentation(info = "<html><p><code>A = A_max (leak + ramp(x - overlap)/(1 - overlap))</code>, flow as in <code>Orifice</code>. Overlap positive: closed over that travel; negative: open in the middle. Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, section 5.1.</p></html>"));
end SpoolEdge;
