within Signal;
block Step "Step"
  extends Bases.Source;
  parameter Real height = 1 "Height";
  parameter Real offset = 0 "Value before the step";
  parameter SI.Time startTime = 0 "Time of the step";
equation
  y = offset + (if time < startTime then 0 else height);
  annotation(Documentation(info = "<html><p><code>offset</code> before the start time, <code>offset + height</code> from then on; an event.</p></html>"));
end Step;
