within Hydraulic.Bases;
partial model HeatExchanger "Two ports between which the oil gives heat to a coolant; who extends it says how much"
  extends TwoPort(
    port_a(dT_outflow = if oil.thermal then T_ba - oil.T_0 - effectiveness*(T_ba - T_coolant) else 0),
    port_b(dT_outflow = if oil.thermal then T_ab - oil.T_0 - effectiveness*(T_ab - T_coolant) else 0));
  parameter SI.Pressure dp_nom(min = 1, nominal = 1e4) = 5e4 "Pressure drop at q_nom";
  parameter SI.VolumeFlowRate q_nom(min = 1e-8, nominal = 1e-3) = 1e-3 "Flow of dp_nom";
  parameter SI.DynamicViscosity mu_nom(min = 1e-4, max = 10, nominal = 0.03) = 0.04 "Viscosity of the nominal point";
  parameter SI.ThermalConductance kA(min = 0, max = 1e6, nominal = 100) = 300 "Heat transfer to the coolant";
  SI.HeatFlowRate Q_flow(nominal = 1e3) "Heat that the coolant takes";
  Real effectiveness(unit = "1") "Fall of the oil's temperature over its distance from that of the coolant at its inlet, where oil carries heat";
  SI.Temperature T_coolant(nominal = 300) "Temperature of the coolant at its inlet";
protected
  SI.Temperature T_ab(nominal = 300) "Temperature of oil that comes in through a, at the pressure of b";
  SI.Temperature T_ba(nominal = 300) "Temperature of oil that comes in through b, at the pressure of a";
  SI.ThermalConductance C_oil(nominal = 1e3) "Heat capacity that flows by, rounded over a thousandth of that at q_nom";
equation
  assert(dp_nom > 0 and q_nom > 0 and kA >= 0, "The nominal point must be positive, kA not negative");
  q = q_nom/dp_nom*mu_nom/mu_in*dp;
  C_oil = oil.c_p*sqrt(m_flow^2 + (1e-3*oil.rho_0*q_nom)^2);
  if oil.thermal then
    T_ab = oil.T_0 + inStream(port_a.dT_outflow) + dT_gain;
    T_ba = oil.T_0 + inStream(port_b.dT_outflow) - dT_gain;
    Q_flow = oil.c_p*effectiveness*(max(m_flow, 0)*(T_ab - T_coolant) + max(-m_flow, 0)*(T_ba - T_coolant));
  else
    T_ab = oil.T;
    T_ba = oil.T;
  end if;
  annotation(Documentation(info = "<html><p>Laminar pressure drop, <code>q = q_nom dp/dp_nom</code> at the nominal viscosity. Oil that carries heat leaves with <code>T - effectiveness (T - T_coolant)</code>, in either direction of flow. Source: W. M. Kays and A. L. London, Compact Heat Exchangers, 1984.</p></html>"));
end HeatExchanger;
