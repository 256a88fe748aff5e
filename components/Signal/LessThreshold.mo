within Signal;
block LessThreshold "True below a threshold"
  Interfaces.RealInput u "Input";
  parameter Real threshold = 0 "Threshold";
  Interfaces.BooleanOutput y "Output";
equation
  y = u < threshold;
  annotation(Documentation(info = "<html><p>True below the threshold; passing it is an event. A limit switch of a cylinder.</p></html>"));
end LessThreshold;
