within Thermal;
model TemperatureSensor "Temperature of a node"
  Interfaces.HeatPort port "Port";
  Interfaces.RealOutput T(unit = "K") "Temperature";
equation
  T = port.T;
  port.Q_flow = 0;
  annotation(Documentation(info = "<html><p>Without influence on the temperature.</p></html>"));
end TemperatureSensor;
