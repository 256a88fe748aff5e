within Pneumatic;
model VariableOrifice "Restriction whose sonic conductance follows a signal"
  extends Bases.TwoPort;
  parameter Real C_max(unit = "m3/(s.Pa)", min = 1e-14, max = 1e-5, nominal = 1e-8) = 1e-8 "Sonic conductance at u = 1; 1e-8 m3/(s.Pa) is 1 dm3/(s.bar)";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-5 "Sonic conductance at u = 0 over C_max";
  parameter Real b(unit = "1", min = 0, max = 0.8) = 0.3 "Critical pressure ratio";
  parameter Real m(unit = "1", min = 0.4, max = 1) = 0.5 "Subsonic index";
  parameter Real beta_lam(unit = "1", min = 0.9, max = 0.99999) = 0.999 "Pressure ratio at which the flow turns laminar";
  Interfaces.RealInput u "Opening, 0 to 1";
  Real C(unit = "m3/(s.Pa)", nominal = 1e-8) "Sonic conductance";
equation
  assert(C_max > 0 and leak > 0, "The sonic conductance C_max and the leakage leak must be positive");
  assert(b >= 0 and b < 1, "The critical pressure ratio b must lie from 0 to below 1");
  assert(beta_lam > b and beta_lam < 1, "The pressure ratio of laminar flow beta_lam must lie between b and 1");
  C = C_max*(leak + min(max(u, 0), 1));
  m_flow = Functions.isoFlow(port_a.p, port_b.p, T, C, b, m, beta_lam, gas.rho_0, gas.T_0);
  annotation(Documentation(info = "<html><p><code>C = C_max (leak + u)</code>, u limited to 0 to 1; flow as in <code>Orifice</code>: a throttle turned by hand, or the last stage of a valve whose opening is known. b does not change with the opening. Source: ISO 6358-1:2013.</p></html>"));
end VariableOrifice;
