within Pneumatic;
model Volume "Gas in a rigid volume"
  extends Bases.Content;
  PneumaticPort port "Port";
  parameter SI.Volume V(min = 1e-9, max = 1000, nominal = 1e-3, displayUnit = "l") = 1e-3 "Volume";
equation
  assert(V > 0, "The volume V must be positive");
  V_gas = V;
  V_flow = 0;
  port.p = p;
  port.h_outflow = gas.c_p*T;
  m_flow = port.m_flow;
  H_flow = max(port.m_flow, 0)*inStream(port.h_outflow) + min(port.m_flow, 0)*gas.c_p*T;
  annotation(Documentation(info = "<html>
<p><code>V/(kappa - 1) dp/dt = m_flow h + Q_flow</code> and <code>dm/dt = m_flow</code>, see <code>Bases.Content</code>; h is that of what comes in, or <code>c_p T</code> of what leaves. States: <code>p</code> and <code>T</code>.</p>
<p>Any number of lines may be joined to the port; they mix in the node, and only their sum enters the volume. Where gas flows through a volume and shall take its temperature, use <code>Receiver</code>, with two ports.
Two volumes joined without a restriction have one pressure, by index reduction; the start that the circuit gives one of them counts for both.</p>
<p>Source: P. Beater, Pneumatic Drives, Springer 2007, chapter on chambers.</p></html>"));
end Volume;
