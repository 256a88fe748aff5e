within Pneumatic.Functions;
function isoFlow "Mass flow through a restriction by ISO 6358, both directions"
  input SI.Pressure p_a "Pressure at a";
  input SI.Pressure p_b "Pressure at b";
  input SI.Temperature T "Temperature upstream";
  input Real C(unit = "m3/(s.Pa)") "Sonic conductance";
  input Real b(unit = "1") = 0.3 "Critical pressure ratio";
  input Real m(unit = "1") = 0.5 "Subsonic index";
  input Real beta_lam(unit = "1") = 0.999 "Pressure ratio at which the flow turns laminar";
  input SI.Density rho_0 = 1.185 "Density of the reference atmosphere";
  input SI.Temperature T_0 = 293.15 "Temperature of the reference atmosphere";
  input SI.Pressure p_min = 1 "Least pressure upstream";
  output SI.MassFlowRate m_flow(nominal = 1e-2) "Mass flow from a to b";
protected
  SI.Pressure p_up "Pressure upstream";
  Real t(unit = "1") "Width of the laminar transition, in z";
  Real z(unit = "1") "Pressure drop over that of choking, with sign, at most 1";
algorithm
  p_up := max(max(p_a, p_b), p_min);
  t := (1 - beta_lam)/(1 - b);
  z := min(max((p_a - p_b)/(p_up*(1 - b)), -1), 1);
  m_flow := C*rho_0*p_up*sqrt(T_0/T)*z*(2 - abs(z))^m*((1 + t*t)/(z*z + t*t))^((1 - m)/2);
  annotation(Inline = true, Documentation(info = "<html>
<p>With the pressure p_1 and the temperature T_1 upstream and the ratio <code>r = p_2/p_1</code>: <code>m_flow = C rho_0 p_1 sqrt(T_0/T_1)</code> where the flow is choked, <code>r <= b</code>;
<code>m_flow = C rho_0 p_1 sqrt(T_0/T_1) (1 - ((r - b)/(1 - b))^2)^m</code> above. C is given for the reference atmosphere.</p>
<p>Near no flow the law has an infinite slope. With <code>z = (1 - r)/(1 - b)</code> the bracket is <code>z (2 - z)</code>; here <code>z^m</code> is replaced by
<code>z ((1 + t^2)/(z^2 + t^2))^((1 - m)/2)</code>, <code>t = (1 - beta_lam)/(1 - b)</code>: proportional to z below beta_lam, smooth, odd in the pressure drop and exact where choked. The flow
lies below the standard by 16 % at r = 0.999, by 0.25 % at r = 0.99, by 0.01 % at r = 0.95 (m = 0.5, beta_lam = 0.999).
A pressure upstream below <code>p_min</code> counts as <code>p_min</code>.</p>
<p>Source: ISO 6358-1:2013 (C, b, subsonic index m; there with a cracking pressure, here 0); F. E. Sanville, Fluid Power Symposium, BHRA 1971, for the ellipse, m = 0.5.</p></html>"));
end isoFlow;
