within Signal;
block Step "Step"
  extends Bases.Source;
  parameter Real height = 1 "Height";
  parameter Real offset = 0 "Value before the step";
  parameter SI.Time startTime = 0 "Time of the step";
equation
  y = offset + (if time < startTime then 0 else height);
end Step;
