within Hydraulic;
model PressureCompensator "Pressure compensator from a to b: keeps the pressure at b a spring above the pilot"
  extends Bases.TwoPort;
  Interfaces.HydraulicPort port_y "Pilot behind the metering orifice; takes no flow";
  parameter SI.Pressure dp_set(min = 1e4, max = 1e7, nominal = 1e6) = 8e5 "Pressure of the spring: p_b above the pilot at which it is closed";
  parameter Real droop(unit = "1", min = 0.005, max = 1) = 0.1 "Fall of that difference from closed to fully open, over dp_set";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 1e-3 "Flow when fully open, at dp_nom";
  parameter SI.Pressure dp_nom(min = 1e3, nominal = 1e5) = 3e5 "Pressure drop of q_nom";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-2) = 5e-3 "Time constant of the opening";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  Real x(unit = "1", start = 1, fixed = true) "Opening, 0 to 1";
protected
  parameter SI.Area A_max = q_nom/(C_d*sqrt(2*dp_nom/oil.rho_0)) "Cross section when open";
equation
  assert(dp_set > 0 and q_nom > 0 and droop > 0 and tau > 0, "dp_set, q_nom, droop and tau must be positive");
  tau*der(x) = Smooth.clip((dp_set - (port_b.p - port_y.p))/(droop*dp_set), 0.1) - x;
  q = Functions.orificeFlow(dp, A_leak + max(x, 0)*A_max, C_d, rho, mu_in, Re_cr);
  port_y.q = 0;
  annotation(Documentation(info = "<html><p>The spool closes as <code>p_b - p_y</code> nears <code>dp_set</code>: put before a metering orifice with the pilot behind it, the drop over the orifice stays between <code>(1 - droop) dp_set</code> and <code>dp_set</code> whatever supply and load do. The fall of the spring force over the stroke and the flow force together are the <code>droop</code>.</p>
<p>Valid for frequencies below some 30 Hz. Source: W. Backe and H. Murrenhoff, Grundlagen der Oelhydraulik, 1994.</p></html>"));
end PressureCompensator;
