within Hydraulic.Bases;
partial model TwoPort "Two ports that exchange oil without storing it"
  Interfaces.HydraulicPort port_a(dT_outflow = if oil.thermal then inStream(port_b.dT_outflow) - dT_gain else 0) "Port a";
  Interfaces.HydraulicPort port_b(dT_outflow = if oil.thermal then inStream(port_a.dT_outflow) + dT_gain else 0) "Port b";
  outer Oil.Fluid oil "Oil of the circuit";
  parameter Boolean useHeatPort = false "true: the power lost heats what is joined to heatPort instead of the oil" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(Q_flow = -lossPower) if useHeatPort "Heat of the losses";
  SI.Pressure dp(nominal = 1e6) "Pressure drop from a to b";
  SI.MassFlowRate m_flow(nominal = 0.1) "Mass flow from a to b";
  SI.VolumeFlowRate q(nominal = 1e-4) "Volume flow from a to b at the density rho";
  SI.Power lossPower(nominal = 10) "Power lost";
  SI.Temperature T_oil(nominal = 300) "Temperature of the oil that comes in";
protected
  SI.DynamicViscosity mu_in(nominal = 0.03) "Viscosity of the oil that comes in, at low pressure";
  SI.TemperatureDifference dT_gain(nominal = 1) "Rise of the temperature from a to b";
  constant Real G_start(unit = "kg/(s.Pa)") = 1e-7 "Conductance from which the search for the start sets out: 6 l/min at 10 bar";
  SI.Density rho_a(nominal = 1000) "Density at a, at T_0";
  SI.Density rho_b(nominal = 1000) "Density at b, at T_0";
  Real full(unit = "1") "Density upstream over that of the oil between its voids: 1 where it has none";
  SI.SpecificEnthalpy w_void(nominal = 1e3) "What the voids of a add to the work of the pressure drop, less those of b";
  SI.Density rho(nominal = 1000) "Density of what flows: mean of both sides without the voids of the lower one; voids of the side it comes from count";
equation
  assert(min(port_a.p, port_b.p) > -1e3, "The absolute pressure falls to " + String(min(port_a.p, port_b.p)) + " Pa: more is drawn from a place without volume than comes. Join a Hydraulic.Volume there; at a line, volume_a or volume_b is one");
  dp = port_a.p - port_b.p;
  rho_a = oil.density(port_a.p);
  rho_b = oil.density(port_b.p);
  full = Smooth.blend(dp, 1e3, min(rho_a/oil.rho_l, 1), min(rho_b/oil.rho_l, 1));
  if oil.thermal then
    T_oil = oil.T_0 + Smooth.blend(dp, 1e3, inStream(port_a.dT_outflow), inStream(port_b.dT_outflow));
    mu_in = oil.viscosity(T_oil);
    dT_gain = oil.throttling(port_a.p) - oil.throttling(port_b.p) - (if useHeatPort then (dp*full/rho + w_void)/oil.c_p else 0);
    rho = (max(rho_a, oil.rho_l) + max(rho_b, oil.rho_l))/2*full/oil.growth(T_oil);
  else
    T_oil = oil.T;
    mu_in = oil.mu;
    dT_gain = 0;
    rho = (max(rho_a, oil.rho_l) + max(rho_b, oil.rho_l))/2*full;
  end if;
  m_flow = homotopy(rho*q, G_start*dp);
  w_void = oil.voidWork(port_a.p) - oil.voidWork(port_b.p);
  lossPower = dp*q*full + m_flow*w_void;
  rho_a*port_a.q = m_flow;
  rho_b*port_b.q = -m_flow;
  annotation(Documentation(info = "<html><p>A component adds one equation, for <code>q</code> or <code>m_flow</code> over <code>dp</code>. Passive where <code>q*dp >= 0</code>.</p>
<p><b>Cavitation</b>: what flows has the mean density of both sides, voids left out (<code>oil.rho_l</code>): they open behind the restriction, so that its mass flow grows to that of the full drop to the vapour pressure, <code>C_d A sqrt(2 rho (p_in - p_v))</code> for an orifice, and stays: choked. Voids in what comes in count by their density, so that nothing flows out of a place at the vapour pressure. With liquid on both sides the density is the mean one. The power lost is the mass flow times the integral of dp/rho: with liquid by the mean density, in voids by the law itself. Source: W. H. Nurick, J. Fluids Eng. 98 (1976) 681, with C_d for the coefficient of contraction, 0.62.</p>
<p><b>Heat</b>, where oil carries it: a throttle keeps the enthalpy, so that the power lost heats the oil behind it, by <code>(1 - gamma T_0) dp/(rho c_p)</code>, 0.48 K per MPa with the default oil; with <code>useHeatPort</code> it goes to what is joined there instead. Viscosity and density are those of the oil that comes in, rounded over a kilopascal about standstill.</p></html>"));
end TwoPort;
