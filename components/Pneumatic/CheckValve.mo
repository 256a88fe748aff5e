within Pneumatic;
model CheckValve "Check valve, static: free from a to b"
  extends Bases.TwoPort;
  parameter SI.Pressure p_crack(min = 0, max = 5e6, nominal = 1e4, displayUnit = "bar") = 0.05e5 "Pressure drop at which it begins to open";
  parameter SI.Pressure p_open(min = 1, max = 1e7, nominal = 1e4, displayUnit = "bar") = 0.2e5 "Pressure drop at which it is open";
  parameter Real C_max(unit = "m3/(s.Pa)", min = 1e-14, max = 1e-5, nominal = 1e-8) = 1e-8 "Sonic conductance when open; 1e-8 m3/(s.Pa) is 1 dm3/(s.bar)";
  parameter Real leak(unit = "1", min = 1e-9, max = 0.1) = 1e-6 "Sonic conductance when closed over C_max";
  parameter Real b(unit = "1", min = 0, max = 0.8) = 0.3 "Critical pressure ratio";
  parameter Real m(unit = "1", min = 0.4, max = 1) = 0.5 "Subsonic index";
  parameter Real beta_lam(unit = "1", min = 0.9, max = 0.99999) = 0.999 "Pressure ratio at which the flow turns laminar";
  Real x(unit = "1") "Opening, 0 to 1";
equation
  assert(p_open > p_crack, "p_open must lie above p_crack");
  assert(C_max > 0 and leak > 0, "The sonic conductance C_max and the leakage leak must be positive");
  assert(beta_lam > b and beta_lam < 1, "The pressure ratio of laminar flow beta_lam must lie between b and 1");
  x = Smooth.step((dp - p_crack)/(p_open - p_crack));
  m_flow = Functions.isoFlow(port_a.p, port_b.p, T, C_max*(leak + x), b, m, beta_lam, gas.rho_0, gas.T_0);
  annotation(Documentation(info = "<html><p>The sonic conductance grows smoothly from <code>leak C_max</code> to <code>C_max</code> between <code>p_crack</code> and <code>p_open</code>. No event, no mass of the poppet: the valve is faster than the circuit. Source: the flow is that of <code>Orifice</code>, ISO 6358-1:2013; the form of the opening as in <code>Hydraulic.CheckValve</code>.</p></html>"));
end CheckValve;
