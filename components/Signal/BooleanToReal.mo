within Signal;
block BooleanToReal "Real values of a Boolean signal"
  parameter Real realTrue = 1 "Output for true";
  parameter Real realFalse = 0 "Output for false";
  Interfaces.BooleanInput u "Input";
  Interfaces.RealOutput y "Output";
equation
  y = if u then realTrue else realFalse;
  annotation(Documentation(info = "<html><p>One of two values, by a condition.</p></html>"));
end BooleanToReal;
