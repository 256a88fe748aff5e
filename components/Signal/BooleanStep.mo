within Signal;
block BooleanStep "Becomes true, or false, at a time"
  parameter SI.Time startTime = 0 "Time of the change";
  parameter Boolean startValue = false "Value before";
  Interfaces.BooleanOutput y "Output";
equation
  y = if time >= startTime then not startValue else startValue;
  annotation(Documentation(info = "<html><p>False before, true from the start time on.</p></html>"));
end BooleanStep;
