within Thermal;
model HeatFlowSensor "Heat flow between two ports"
  Interfaces.HeatPort port_a "Port a";
  Interfaces.HeatPort port_b "Port b";
  Interfaces.RealOutput Q_flow(unit = "W") "Heat flow from a to b";
equation
  port_a.T = port_b.T;
  port_a.Q_flow + port_b.Q_flow = 0;
  Q_flow = port_a.Q_flow;
  annotation(Documentation(info = "<html><p>Without influence on the temperatures.</p></html>"));
end HeatFlowSensor;
