within Hydraulic;
model TemperatureSensor "Temperature of the oil of a node"
  Interfaces.HydraulicPort port "Port";
  outer Oil.Fluid oil "Oil of the circuit";
  Interfaces.RealOutput T(unit = "K", nominal = 300) "Temperature";
equation
  T = if oil.thermal then oil.T_0 + inStream(port.dT_outflow) else oil.T;
  port.q = 0;
  annotation(Documentation(info = "<html><p>Temperature of what flows through the node, of the volume there if it has one; without flow and without delay. Where nothing flows it is that of the oil that would flow in. Where the oil has one temperature for the circuit, that.</p></html>"));
end TemperatureSensor;
