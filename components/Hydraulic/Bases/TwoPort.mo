within Hydraulic.Bases;
partial model TwoPort "Two ports that exchange oil without storing it"
  Interfaces.HydraulicPort port_a "Port a";
  Interfaces.HydraulicPort port_b "Port b";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the losses";
  SI.Pressure dp(nominal = 1e6) "Pressure drop from a to b";
  SI.MassFlowRate m_flow(nominal = 0.1) "Mass flow from a to b";
  SI.VolumeFlowRate q(nominal = 1e-4) "Volume flow from a to b at mean density";
  SI.Power lossPower(nominal = 10) "Power lost";
protected
  SI.Density rho_a(nominal = 1000) "Density at a";
  SI.Density rho_b(nominal = 1000) "Density at b";
  SI.Density rho(nominal = 1000) "Mean density";
equation
  dp = port_a.p - port_b.p;
  rho_a = oil.density(port_a.p);
  rho_b = oil.density(port_b.p);
  rho = (rho_a + rho_b)/2;
  m_flow = rho*q;
  lossPower = dp*q;
  rho_a*port_a.q = m_flow;
  rho_b*port_b.q = -m_flow;
  annotation(Documentation(info = "<html><p>A component adds one equation, for <code>q</code> or <code>m_flow</code> over <code>dp</code>. Passive where <code>q*dp >= 0</code>.</p></html>"));
end TwoPort;
