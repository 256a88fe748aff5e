within Signal;
block OnDelay "True when the input has been true for a time"
  Interfaces.BooleanInput u "Input";
  Interfaces.BooleanOutput y "Output";
  parameter SI.Time delay(min = 0, nominal = 1) = 1 "Time that the input must be true";
  discrete SI.Time t_on "When the input became true";
equation
  assert(delay >= 0, "The delay must not be negative");
  when {initial(), u} then
    t_on = time;
  end when;
  y = u and time >= t_on + delay;
  annotation(Documentation(info = "<html><p>The timer of a controller: true <code>delay</code> after the input became true, false at once with it. An input that is true at the start counts from there.</p></html>"));
end OnDelay;
