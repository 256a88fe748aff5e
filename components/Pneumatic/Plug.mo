within Pneumatic;
model Plug "Closed end of a line"
  PneumaticPort port(m_flow(min = 0)) "Port";
  outer Gas gas "Gas of the circuit";
equation
  port.m_flow = 0;
  port.h_outflow = gas.c_p*gas.T_0;
  annotation(Documentation(info = "<html><p>No flow: closes a port that is not used.</p></html>"));
end Plug;
