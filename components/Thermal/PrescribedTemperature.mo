within Thermal;
model PrescribedTemperature "Temperature given by a signal"
  Interfaces.HeatPort port "Port";
  Interfaces.RealInput T(unit = "K") "Temperature";
equation
  port.T = T;
end PrescribedTemperature;
