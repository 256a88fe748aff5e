within Pneumatic;
model Receiver "Air receiver: rigid volume that gas flows through"
  extends Bases.Content;
  PneumaticPort port_a "Port a";
  PneumaticPort port_b "Port b";
  parameter SI.Volume V(min = 1e-9, max = 1000, nominal = 1e-2, displayUnit = "l") = 1e-2 "Volume";
equation
  assert(V > 0, "The volume V must be positive");
  V_gas = V;
  V_flow = 0;
  port_a.p = p;
  port_b.p = p;
  port_a.h_outflow = gas.c_p*T;
  port_b.h_outflow = gas.c_p*T;
  m_flow = port_a.m_flow + port_b.m_flow;
  H_flow = max(port_a.m_flow, 0)*inStream(port_a.h_outflow) + min(port_a.m_flow, 0)*gas.c_p*T + max(port_b.m_flow, 0)*inStream(port_b.h_outflow) + min(port_b.m_flow, 0)*gas.c_p*T;
  annotation(Documentation(info = "<html>
<p>As <code>Volume</code>, with two ports: what enters at one is mixed with the content, and gas leaves with the temperature of the content. No pressure drop.</p>
<p>Source: P. Beater, Pneumatic Drives, Springer 2007, chapter on chambers.</p></html>"));
end Receiver;
