within Pneumatic;
model Orifice "Restriction of constant sonic conductance by ISO 6358"
  extends Bases.TwoPort;
  parameter Real C(unit = "m3/(s.Pa)", min = 1e-16, max = 1e-5, nominal = 1e-8) = 1e-8 "Sonic conductance; 1e-8 m3/(s.Pa) is 1 dm3/(s.bar)";
  parameter Real b(unit = "1", min = 0, max = 0.8) = 0.3 "Critical pressure ratio";
  parameter Real m(unit = "1", min = 0.4, max = 1) = 0.5 "Subsonic index";
  parameter Real beta_lam(unit = "1", min = 0.9, max = 0.99999) = 0.999 "Pressure ratio at which the flow turns laminar";
equation
  assert(C > 0, "The sonic conductance C must be positive");
  assert(b >= 0 and b < 1, "The critical pressure ratio b must lie from 0 to below 1");
  assert(beta_lam > b and beta_lam < 1, "The pressure ratio of laminar flow beta_lam must lie between b and 1");
  m_flow = Functions.isoFlow(port_a.p, port_b.p, T, C, b, m, beta_lam, gas.rho_0, gas.T_0);
  annotation(Documentation(info = "<html>
<p>Choked, <code>p_2/p_1 <= b</code>: <code>m_flow = C rho_0 p_1 sqrt(T_0/T_1)</code>; above: times <code>(1 - ((p_2/p_1 - b)/(1 - b))^2)^m</code>; smooth and laminar within <code>beta_lam < p_2/p_1</code>: see <code>Functions.isoFlow</code>. The same law in both directions, passive everywhere, isenthalpic at steady flow (see <code>Bases.TwoPort</code>).</p>
<p>A sharp-edged hole of the cross section A has about <code>C = 0.128 d^2</code> (C in dm3/(s.bar), d in mm; a discharge coefficient of 0.82) and b from 0.2 to 0.5.</p>
<p>Source: ISO 6358-1:2013.</p></html>"));
end Orifice;
