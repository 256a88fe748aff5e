within Hydraulic;
model HydraulicFuse "Hose-break valve: closes when too much flows from a to b, free from b to a"
  extends Bases.TwoPort;
  parameter SI.VolumeFlowRate q_close(min = 1e-8, max = 0.1, nominal = 1e-3) = 5e-4 "Flow from a to b at which it closes";
  parameter SI.Pressure dp_close(min = 1e4, max = 5e6, nominal = 1e5) = 4e5 "Pressure drop of the open valve at q_close";
  parameter SI.Pressure dp_reset(min = -1e6, max = 5e6, nominal = 1e5) = 1e5 "Pressure drop below which the closed valve opens again";
  parameter SI.Time tau(min = 1e-5, max = 1, nominal = 1e-2) = 1e-2 "Time constant of closing and opening";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-5, nominal = 1e-9) = 1e-9 "Cross section when closed; a bore lets the load down slowly";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  Boolean closed(start = false, fixed = true) "true: it has closed";
  Real x(unit = "1", start = 1, fixed = true) "Opening, 0 to 1";
protected
  parameter SI.Area A_max = q_close/(C_d*sqrt(2*dp_close/oil.rho_0)) "Cross section when open";
equation
  assert(q_close > 0 and dp_close > 0 and tau > 0, "q_close, dp_close and tau must be positive");
  assert(dp_reset < dp_close, "dp_reset must lie below dp_close: otherwise it would open again as soon as it closes");
  assert(A_leak > 0, "The cross section A_leak must be positive");
  closed = not pre(closed) and dp > dp_close or pre(closed) and dp > dp_reset;
  tau*der(x) = (if closed then 0 else 1) - x;
  q = Functions.orificeFlow(dp, A_leak + max(x, 0)*A_max, C_d, rho, mu_in, Re_cr);
  annotation(Documentation(info = "<html><p>The plate is held open by a spring and pushed shut by the drop that the flow makes: the valve closes when <code>dp > dp_close</code>, which the open valve has at <code>q_close</code>, and opens again below <code>dp_reset</code>: when oil is fed back from b, or the pressures come level through <code>A_leak</code>. Both are events; the motion of the plate is a lag. Mount it with a at the consumer and b at the hose.</p>
<p>Valid for sharp-edged valves, whose setting does not change with viscosity. The drop sets off the valve: a sudden acceleration of the load does it too, as on the machine. Passive, flow both ways. Source: what such a valve has to do on excavators is in ISO 8643 (lowering control devices); the values are assumed.</p></html>"));
end HydraulicFuse;
