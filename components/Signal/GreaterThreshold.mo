within Signal;
block GreaterThreshold "True above a threshold"
  Interfaces.RealInput u "Input";
  parameter Real threshold = 0 "Threshold";
  Interfaces.BooleanOutput y "Output";
equation
  y = u > threshold;
  annotation(Documentation(info = "<html><p>True above the threshold; passing it is an event.</p></html>"));
end GreaterThreshold;
