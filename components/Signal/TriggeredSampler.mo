within Signal;
block TriggeredSampler "Holds the input as it was at the last rising edge of a trigger"
  extends Bases.OneToOne(y(start = y_start, fixed = true));
  Interfaces.BooleanInput trigger "Samples when it becomes true";
  parameter Real y_start = 0 "Output before the first sample";
equation
  when trigger then
    y = u;
  end when;
  annotation(Documentation(info = "<html><p>The value at an event, kept: the pressure at the end of a stroke, the position where a switch closed.</p></html>"));
end TriggeredSampler;
