within Pneumatic;
model FlowSensor "Mass flow and standard volume flow through a line"
  PneumaticPort port_a "Port a";
  PneumaticPort port_b "Port b";
  outer Gas gas "Gas of the circuit";
  Interfaces.RealOutput m_flow(unit = "kg/s", nominal = 1e-2) "Mass flow from a to b";
  Interfaces.RealOutput q(unit = "m3/s", nominal = 1e-2) "Volume flow from a to b at the reference atmosphere (ANR)";
equation
  port_a.p = port_b.p;
  port_a.m_flow + port_b.m_flow = 0;
  port_a.h_outflow = inStream(port_b.h_outflow);
  port_b.h_outflow = inStream(port_a.h_outflow);
  m_flow = port_a.m_flow;
  q = m_flow/gas.rho_0;
  annotation(Documentation(info = "<html><p>Without pressure drop. <code>q = m_flow/rho_0</code> with the density of the reference atmosphere of the gas (ANR by ISO 8778).</p></html>"));
end FlowSensor;
