within Signal;
block Hysteresis "Switch with hysteresis"
  parameter Real uLow = 0 "Switches off below";
  parameter Real uHigh = 1 "Switches on above";
  parameter Boolean y_start = false "Output before the start";
  Interfaces.RealInput u "Input";
  Interfaces.BooleanOutput y(start = y_start, fixed = true) "Output";
equation
  assert(uHigh > uLow, "uHigh must lie above uLow");
  y = not pre(y) and u > uHigh or pre(y) and u >= uLow;
  annotation(Documentation(info = "<html><p>Becomes true above <code>uHigh</code> and false below <code>uLow</code>.</p></html>"));
end Hysteresis;
