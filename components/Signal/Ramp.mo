within Signal;
block Ramp "Ramp to a new value"
  extends Bases.Source;
  parameter Real height = 1 "Height";
  parameter SI.Time duration(min = 0) = 1 "Duration; 0 gives a step";
  parameter Real offset = 0 "Value before the ramp";
  parameter SI.Time startTime = 0 "Begin of the ramp";
equation
  y = offset + (if time < startTime then 0
    elseif time < startTime + duration then (time - startTime)*height/duration
    else height);
  annotation(Documentation(info = "<html><p>Straight from <code>offset</code> to <code>offset + height</code>; both corners are events.</p></html>"));
end Ramp;
