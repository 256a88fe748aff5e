within Signal;
block FixedDelay "Exact delay of a signal by a fixed time"
  extends Bases.OneToOne;
  parameter SI.Time delayTime(min = 1e-9, nominal = 0.01) = 0.01 "Delay";
equation
  assert(delayTime > 0, "The delay must be positive");
  y = delay(u, delayTime);
  annotation(Documentation(info = "<html><p><code>y(t) = u(t - delayTime)</code>, jumps and bends included; before one delay has passed the value at the start. Where a model is made linear or fitted, take <code>PadeDelay</code>, which has finitely many states.</p></html>"));
end FixedDelay;
