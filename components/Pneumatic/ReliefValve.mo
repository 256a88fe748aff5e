within Pneumatic;
model ReliefValve "Relief valve, static: opens from a to b above its setting"
  extends Bases.TwoPort;
  parameter SI.Pressure p_set(min = 1e3, max = 1e7, nominal = 1e5, displayUnit = "bar") = 7e5 "Pressure drop at which it begins to open";
  parameter Real override(unit = "1", min = 0.005, max = 1) = 0.1 "Rise of pressure from cracking to fully open, over p_set";
  parameter Real C_max(unit = "m3/(s.Pa)", min = 1e-14, max = 1e-5, nominal = 1e-8) = 2e-8 "Sonic conductance when open; 1e-8 m3/(s.Pa) is 1 dm3/(s.bar)";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-6 "Sonic conductance when closed over C_max";
  parameter Real b(unit = "1", min = 0, max = 0.8) = 0.3 "Critical pressure ratio";
  parameter Real m(unit = "1", min = 0.4, max = 1) = 0.5 "Subsonic index";
  parameter Real beta_lam(unit = "1", min = 0.9, max = 0.99999) = 0.999 "Pressure ratio at which the flow turns laminar";
  Real x(unit = "1") "Opening, 0 to 1";
equation
  assert(p_set > 0 and override > 0, "The setting p_set and the override must be positive");
  assert(C_max > 0 and leak > 0, "The sonic conductance C_max and the leakage leak must be positive");
  assert(beta_lam > b and beta_lam < 1, "The pressure ratio of laminar flow beta_lam must lie between b and 1");
  x = Smooth.clip((dp - p_set)/(override*p_set), 0.1);
  m_flow = Functions.isoFlow(port_a.p, port_b.p, T, C_max*(leak + x), b, m, beta_lam, gas.rho_0, gas.T_0);
  annotation(Documentation(info = "<html><p>The opening grows in proportion to the pressure drop above <code>p_set</code>, the corners rounded over a tenth of the range, and is full at <code>p_set (1 + override)</code>. Closed in the other direction. No mass of the poppet, no hysteresis of safety valves that pop open. Source: form of <code>Hydraulic.ReliefValve</code>; flow by ISO 6358-1:2013.</p></html>"));
end ReliefValve;
