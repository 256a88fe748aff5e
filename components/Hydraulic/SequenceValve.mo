within Hydraulic;
model SequenceValve "Sequence valve: opens from a to b at a pressure at a, whatever the pressure at b"
  extends Bases.TwoPort;
  parameter SI.Pressure p_set(min = 1e3, max = 1e8, nominal = 1e7) = 100e5 "Pressure at a above p_ref at which it begins to open";
  parameter SI.Pressure p_ref(nominal = 1e5) = 101325 "Pressure of the spring chamber, drained outside";
  parameter Real override(unit = "1", min = 0.005, max = 1) = 0.05 "Rise of that pressure to fully open, over p_set";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 1e-3 "Flow when fully open, at dp_nom";
  parameter SI.Pressure dp_nom(min = 1e3, nominal = 1e6) = 5e5 "Pressure drop of q_nom";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-2) = 5e-3 "Time constant of the opening";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  Real x(unit = "1", start = 0, fixed = true) "Opening, 0 to 1";
protected
  parameter SI.Area A_max = q_nom/(C_d*sqrt(2*dp_nom/oil.rho_0)) "Cross section when open";
equation
  assert(p_set > 0 and q_nom > 0 and tau > 0, "p_set, q_nom and tau must be positive");
  tau*der(x) = Smooth.clip((port_a.p - p_ref - p_set)/(override*p_set), 0.1) - x;
  q = Functions.orificeFlow(dp, A_leak + max(x, 0)*A_max, C_d, rho, mu_in, Re_cr);
  annotation(Documentation(info = "<html><p>The second consumer gets oil when the first has reached its pressure. Unlike <code>ReliefValve</code> it looks at the pressure at a alone, and its nominal drop is small. Back from b to a it lets oil only while it is open: add a <code>CheckValve</code>. With a pilot from elsewhere: <code>UnloadingValve</code>. Source: H. Murrenhoff, Grundlagen der Fluidtechnik 1: Hydraulik, 2012.</p></html>"));
end SequenceValve;
