within Signal;
block EdgeCounter "Counts how often the input becomes true"
  Interfaces.BooleanInput u "Input";
  Interfaces.IntegerOutput y(start = 0, fixed = true) "Number of rising edges";
equation
  when u then
    y = pre(y) + 1;
  end when;
  annotation(Documentation(info = "<html><p>Strokes of a press, switching of a valve: each rising edge counts one.</p></html>"));
end EdgeCounter;
