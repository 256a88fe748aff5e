within Thermal;
model FixedTemperature "Constant temperature"
  Interfaces.HeatPort port "Port";
  parameter SI.Temperature T(min = 0) = 293.15 "Temperature";
equation
  port.T = T;
end FixedTemperature;
