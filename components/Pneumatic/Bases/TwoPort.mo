within Pneumatic.Bases;
partial model TwoPort "Restriction between two ports: gas passes without heat or work"
  PneumaticPort port_a "Port a";
  PneumaticPort port_b "Port b";
  outer Gas gas "Gas of the circuit";
  parameter SI.Mass m_gas(min = 1e-9, max = 1e-2, nominal = 1e-6) = 1e-6 "Mass of the gas within the restriction: delays its temperature";
  SI.Pressure dp(nominal = 1e5) "Pressure drop from a to b";
  SI.MassFlowRate m_flow(nominal = 1e-2) "Mass flow from a to b";
  SI.VolumeFlowRate q(nominal = 1e-2) "Volume flow from a to b at the reference atmosphere (ANR)";
  SI.Temperature T(start = gas.T_0, fixed = true, nominal = 300) "Temperature of the gas within";
equation
  assert(m_gas > 0, "The mass of the gas within, m_gas, must be positive");
  dp = port_a.p - port_b.p;
  port_a.m_flow = m_flow;
  port_b.m_flow = -m_flow;
  q = m_flow/gas.rho_0;
  port_a.h_outflow = gas.c_p*T;
  port_b.h_outflow = gas.c_p*T;
  m_gas*der(T) = max(m_flow, 0)*(inStream(port_a.h_outflow)/gas.c_p - T) + max(-m_flow, 0)*(inStream(port_b.h_outflow)/gas.c_p - T);
  annotation(Documentation(info = "<html>
<p>A component adds one equation, for <code>m_flow</code> over the pressures and the temperature T. Passive where <code>m_flow*dp >= 0</code>: a throttled ideal gas keeps its temperature and gains entropy.</p>
<p>The gas within has a constant mass and takes up the temperature of what flows in, <code>m_gas c_p dT/dt = abs(m_flow) c_p (T_in - T)</code>; it leaves with T. At steady flow the restriction is isenthalpic; a change of the temperature upstream arrives after <code>m_gas/abs(m_flow)</code>,
0.2 ms with the defaults at 5 g/s. The energy stored is <code>m_gas c_p T</code>, some 0.3 J. This keeps the temperature defined where the flow stops and turns, and nodes of several restrictions free of loops in the temperature. The default is the content of some 0.1 cm3 at 7 bar; its start is the temperature of the reference atmosphere.</p></html>"));
end TwoPort;
