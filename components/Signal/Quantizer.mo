within Signal;
block Quantizer "Rounds a signal to steps"
  extends Bases.OneToOne;
  parameter Real step(min = 1e-12) = 0.1 "Step";
equation
  assert(step > 0, "The step must be positive");
  y = step*floor(u/step + 0.5);
  annotation(Documentation(info = "<html><p>Rounds to the nearest whole step: the resolution of a converter. Each step is an event.</p></html>"));
end Quantizer;
