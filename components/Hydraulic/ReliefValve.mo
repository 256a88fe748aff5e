within Hydraulic;
model ReliefValve "Relief valve, static: opens from a to b above its setting"
  extends Bases.TwoPort;
  parameter SI.Pressure p_set(min = 1e3, max = 1e8, nominal = 1e7) = 200e5 "Pressure drop at which it begins to open";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, max = 0.1, nominal = 1e-3) = 1e-3 "Flow when fully open, at p_set*(1 + override)";
  parameter Real override(unit = "1", min = 0.005, max = 1) = 0.1 "Rise of pressure from cracking to fully open, over p_set";
  parameter SI.Area A_leak(min = 1e-18, max = 1e-6, nominal = 1e-12) = 1e-12 "Cross section when closed";
  parameter Real C_d(unit = "1", min = 0.1, max = 1) = 0.65 "Discharge coefficient";
  parameter Real Re_cr(unit = "1", min = 1, max = 5000) = 150 "Reynolds number of the laminar transition";
  Real x(unit = "1") "Opening, 0 to 1";
protected
  parameter SI.Density rho_full = (oil.density(oil.p_0) + oil.density(oil.p_0 + p_set*(1 + override)))/2 "Mean density when fully open, the outlet at p_0";
  parameter SI.Area A_max = q_nom/(C_d*sqrt(2*p_set*(1 + override)/rho_full)) "Cross section when open";
equation
  assert(p_set > 0, "The setting p_set must be positive");
  assert(q_nom > 0 and override > 0, "q_nom and override must be positive");
  x = Smooth.clip((dp - p_set)/(override*p_set), 0.1);
  q = Functions.orificeFlow(dp, A_leak + x*A_max, C_d, rho, mu_in, Re_cr);
  annotation(Documentation(info = "<html>
<p>The opening grows in proportion to the pressure above <code>p_set</code>, the corners rounded over a tenth of the range each (<code>Smooth.clip</code>), and is full at
<code>p_set (1 + override)</code> (5 to 10 % is usual), where it passes <code>q_nom</code>, counted at the mean density of both sides. Closed in the other direction. Use <code>ReliefValveDynamic</code> where the delay of
opening matters. Source: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, section 5.7.</p></html>"));
end ReliefValve;
