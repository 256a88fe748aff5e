within Signal;
block FlipFlop "Memory that is set and reset; reset wins"
  Interfaces.BooleanInput set "Makes the output true";
  Interfaces.BooleanInput reset "Makes it false";
  Interfaces.BooleanOutput y(start = y_start, fixed = true) "Output";
  parameter Boolean y_start = false "Output before the start";
equation
  y = not reset and (set or pre(y));
  annotation(Documentation(info = "<html><p><code>y = not reset and (set or pre(y))</code>: steps of a cycle are flip-flops that the next step resets.</p></html>"));
end FlipFlop;
