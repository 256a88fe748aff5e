within Hydraulic;
model UnloadingValve "Unloading valve: opens from a to b at a pilot pressure, with hysteresis"
  extends Bases.TwoPort;
  Interfaces.HydraulicPort port_x "Pilot; takes no flow";
  parameter SI.Pressure p_set(min = 1e3, max = 1e8, nominal = 1e7) = 150e5 "Pilot pressure above p_ref at which it opens";
  parameter Real hysteresis(unit = "1", min = 1e-3, max = 0.9) = 0.15 "It closes at (1 - hysteresis) p_set";
  parameter SI.Pressure p_ref(nominal = 1e5) = 101325 "Pressure of the spring chamber";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 1e-3 "Flow when fully open, at dp_nom";
  parameter SI.Pressure dp_nom(min = 1e3, nominal = 1e6) = 3e5 "Pressure drop of q_nom";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-2) = 1e-2 "Time constant of the opening";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  Boolean unloading(start = false, fixed = true) "true: the pump runs without pressure";
  Real x(unit = "1", start = 0, fixed = true) "Opening, 0 to 1";
protected
  parameter SI.Area A_max = q_nom/(C_d*sqrt(2*dp_nom/oil.rho_0)) "Cross section when open";
  SI.Pressure p_x(nominal = 1e7) "Pilot pressure above p_ref";
equation
  assert(p_set > 0 and q_nom > 0 and tau > 0, "p_set, q_nom and tau must be positive");
  p_x = port_x.p - p_ref;
  unloading = not pre(unloading) and p_x > p_set or pre(unloading) and p_x >= (1 - hysteresis)*p_set;
  tau*der(x) = (if unloading then 1 else 0) - x;
  q = Functions.orificeFlow(dp, A_leak + max(x, 0)*A_max, C_d, rho, mu_in, Re_cr);
  port_x.q = 0;
  annotation(Documentation(info = "<html><p>Charging an accumulator: pump, check valve, accumulator with the pilot behind the check valve; at <code>p_set</code> the pump is joined to the tank, at <code>(1 - hysteresis) p_set</code> it charges again. The snap of the pilot stage is an event, the main spool a lag. Source: H. Murrenhoff, Grundlagen der Fluidtechnik 1: Hydraulik, 2012.</p></html>"));
end UnloadingValve;
