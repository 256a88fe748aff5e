within Pneumatic;
model TemperatureSensor "Temperature of the gas of a node"
  PneumaticPort port(m_flow(min = 0)) "Port";
  outer Gas gas "Gas of the circuit";
  Interfaces.RealOutput T(unit = "K", nominal = 300) "Temperature";
equation
  T = inStream(port.h_outflow)/gas.c_p;
  port.m_flow = 0;
  port.h_outflow = gas.c_p*gas.T_0;
  annotation(Documentation(info = "<html><p>Temperature of what is mixed in the node, without flow and without delay. Where nothing flows it is that of the gas that would flow in.</p></html>"));
end TemperatureSensor;
