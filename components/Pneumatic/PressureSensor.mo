within Pneumatic;
model PressureSensor "Absolute pressure of a node"
  PneumaticPort port(m_flow(min = 0)) "Port";
  outer Gas gas "Gas of the circuit";
  Interfaces.RealOutput p(unit = "Pa", nominal = 1e5) "Absolute pressure";
equation
  p = port.p;
  port.m_flow = 0;
  port.h_outflow = gas.c_p*gas.T_0;
  annotation(Documentation(info = "<html><p>Absolute pressure of the node, without flow.</p></html>"));
end PressureSensor;
