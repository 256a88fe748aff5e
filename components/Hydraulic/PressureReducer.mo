within Hydraulic;
model PressureReducer "Pressure reducing valve from a to b, static, drain to the surroundings"
  extends Bases.TwoPort;
  parameter SI.Pressure p_set(min = 1e3, max = 1e8, nominal = 1e6) = 50e5 "Pressure at b above p_ref at which it is closed";
  parameter SI.Pressure p_ref(nominal = 1e5) = 101325 "Pressure of the spring chamber";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 1e-3 "Flow when fully open, at dp_nom";
  parameter SI.Pressure dp_nom(min = 1e3, nominal = 1e6) = 10e5 "Pressure drop of q_nom";
  parameter Real droop(unit = "1", min = 0.005, max = 1) = 0.1 "Fall of the pressure at b from closed to fully open, over p_set";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-2) = 1e-2 "Time constant of the opening";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  Real x(unit = "1", start = 1, fixed = true) "Opening, 0 to 1";
protected
  parameter SI.Area A_max = q_nom/(C_d*sqrt(2*dp_nom/oil.rho_0)) "Cross section when open";
equation
  assert(p_set > 0 and q_nom > 0 and droop > 0 and tau > 0, "p_set, q_nom, droop and tau must be positive");
  tau*der(x) = Smooth.clip((p_set - (port_b.p - p_ref))/(droop*p_set), 0.1) - x;
  q = Functions.orificeFlow(dp, A_leak + max(x, 0)*A_max, C_d, rho, mu_in, Re_cr);
  annotation(Documentation(info = "<html><p>Open until the pressure at b comes near <code>p_set</code>, closed at it: a lag, without the return path of three-way valves. Oil pushed back into b raises the pressure there (<code>PressureReducerRelieving</code> lets it out). Source: H. Murrenhoff, Grundlagen der Fluidtechnik 1: Hydraulik, 2012.</p></html>"));
end PressureReducer;
