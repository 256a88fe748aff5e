within Hydraulic.Bases;
partial model TwoPort "Two ports that exchange oil without storing it"
  Interfaces.HydraulicPort port_a(dT_outflow = if oil.thermal then inStream(port_b.dT_outflow) - dT_gain else 0) "Port a";
  Interfaces.HydraulicPort port_b(dT_outflow = if oil.thermal then inStream(port_a.dT_outflow) + dT_gain else 0) "Port b";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort instead of the oil" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the losses";
  SI.Pressure dp(nominal = 1e6) "Pressure drop from a to b";
  SI.MassFlowRate m_flow(nominal = 0.1) "Mass flow from a to b";
  SI.VolumeFlowRate q(nominal = 1e-4) "Volume flow from a to b at mean density";
  SI.Power lossPower(nominal = 10) "Power lost";
  SI.Temperature T_oil(nominal = 300) "Temperature of the oil that comes in";
protected
  SI.DynamicViscosity mu_in(nominal = 0.03) "Viscosity of the oil that comes in, at low pressure";
  SI.TemperatureDifference dT_gain(nominal = 1) "Rise of the temperature from a to b";
  SI.Density rho_a(nominal = 1000) "Density at a, at T_0";
  SI.Density rho_b(nominal = 1000) "Density at b, at T_0";
  SI.Density rho(nominal = 1000) "Mean density";
equation
  dp = port_a.p - port_b.p;
  rho_a = oil.density(port_a.p);
  rho_b = oil.density(port_b.p);
  if oil.thermal then
    T_oil = oil.T_0 + Smooth.blend(dp, 1e3, inStream(port_a.dT_outflow), inStream(port_b.dT_outflow));
    mu_in = oil.viscosity(T_oil);
    dT_gain = oil.throttling(port_a.p) - oil.throttling(port_b.p) - (if useHeatPort then dp/(rho*oil.c_p) else 0);
    rho = (rho_a + rho_b)/2/oil.growth(T_oil);
  else
    T_oil = oil.T;
    mu_in = oil.mu;
    dT_gain = 0;
    rho = (rho_a + rho_b)/2;
  end if;
  m_flow = rho*q;
  lossPower = dp*q;
  rho_a*port_a.q = m_flow;
  rho_b*port_b.q = -m_flow;
  annotation(Documentation(info = "<html><p>A component adds one equation, for <code>q</code> or <code>m_flow</code> over <code>dp</code>. Passive where <code>q*dp >= 0</code>.</p>
<p><b>Heat</b>, where oil carries it: a throttle keeps the enthalpy, so that the power lost heats the oil behind it, by <code>(1 - gamma T_0) dp/(rho c_p)</code>, 0.48 K per MPa with the default oil; with <code>useHeatPort</code> it goes to what is joined there instead. Viscosity and density are those of the oil that comes in, rounded over a kilopascal about standstill.</p></html>"));
end TwoPort;
