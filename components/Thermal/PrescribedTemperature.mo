within Thermal;
model PrescribedTemperature "Temperature given by a signal"
  Interfaces.HeatPort port "Port";
  Interfaces.RealInput T(unit = "K") "Temperature";
equation
  port.T = T;
  annotation(Documentation(info = "<html><p>Takes or gives any heat at the temperature of the signal.</p></html>"));
end PrescribedTemperature;
