within Hydraulic;
model PostCompensator "Pressure compensator behind a metering edge: keeps the pressure at a a spring above that of load sensing"
  extends Bases.TwoPort;
  Interfaces.HydraulicPort port_LS "Load sensing: the highest pressure of all consumers; takes no flow";
  parameter SI.Pressure dp_set(min = 1e4, max = 5e6, nominal = 1e6) = 3e5 "Pressure of the spring: p_a above load sensing at which it begins to open";
  parameter SI.Pressure rise(min = 1e3, max = 5e6, nominal = 1e5) = 0.5e5 "Rise of that difference from closed to fully open";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 1e-3 "Flow when fully open, at dp_nom";
  parameter SI.Pressure dp_nom(min = 1e3, nominal = 1e5) = 2e5 "Pressure drop of q_nom";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-2) = 5e-3 "Time constant of the opening";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  Real x(unit = "1", start = 0, fixed = true) "Opening, 0 to 1";
protected
  parameter SI.Area A_max = q_nom/(C_d*sqrt(2*dp_nom/oil.rho_0)) "Cross section when open";
equation
  assert(dp_set > 0 and rise > 0 and q_nom > 0 and dp_nom > 0 and tau > 0, "dp_set, rise, q_nom, dp_nom and tau must be positive");
  tau*der(x) = Smooth.clip((port_a.p - port_LS.p - dp_set)/rise, 0.1) - x;
  q = Functions.orificeFlow(dp, A_leak + max(x, 0)*A_max, C_d, rho, mu_in, Re_cr);
  port_LS.q = 0;
  annotation(Documentation(info = "<html><p>The spool opens as <code>p_a - p_LS</code> passes <code>dp_set</code>, fully at <code>dp_set + 1.1 rise</code>. Put behind each metering edge, with the highest pressure of all consumers at every <code>port_LS</code> (<code>ShuttleValve</code>), it gives all edges the same pressure behind them, so that every edge has the drop <code>p_pump - p_LS - dp_set</code>, to within <code>rise</code>. Where the pump delivers less than is asked for, that drop becomes smaller at all edges alike: the consumers become slower in proportion and none stops.</p>
<p>The compensator of the highest load must pass its flow at <code>dp_set</code>: choose <code>q_nom</code> at <code>dp_nom</code> not above <code>dp_set</code>. It closes where a load would flow back. The lag is assumed; valid for frequencies below some 30 Hz. Source: H. Murrenhoff, Grundlagen der Fluidtechnik 1: Hydraulik, 2012, flow sharing independent of the load pressure.</p></html>"));
end PostCompensator;
