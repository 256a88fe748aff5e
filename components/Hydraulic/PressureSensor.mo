within Hydraulic;
model PressureSensor "Absolute pressure of a node"
  Interfaces.HydraulicPort port "Port";
  Interfaces.RealOutput p(unit = "Pa", nominal = 1e6) "Absolute pressure";
equation
  p = port.p;
  port.q = 0;
  annotation(Documentation(info = "<html><p>Absolute pressure of the node, without flow.</p></html>"));
end PressureSensor;
