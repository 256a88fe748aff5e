within Thermal;
model FixedTemperature "Constant temperature"
  Interfaces.HeatPort port "Port";
  parameter SI.Temperature T(min = 0) = 293.15 "Temperature";
equation
  port.T = T;
  annotation(Documentation(info = "<html><p>Takes or gives any heat at one temperature: the surroundings, or oil whose temperature is held.</p></html>"));
end FixedTemperature;
