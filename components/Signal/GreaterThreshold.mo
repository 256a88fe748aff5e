within Signal;
block GreaterThreshold "True above a threshold"
  Interfaces.RealInput u "Input";
  parameter Real threshold = 0 "Threshold";
  Interfaces.BooleanOutput y "Output";
equation
  y = u > threshold;
end GreaterThreshold;
