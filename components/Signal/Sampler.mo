within Signal;
block Sampler "Sample and hold"
  extends Bases.Sampled(y(start = y_start, fixed = true));
  parameter Real y_start = 0 "Output before the first sample";
equation
  when tick then
    y = u;
  end when;
  annotation(Documentation(info = "<html><p>Takes a sample each period and holds it.</p></html>"));
end Sampler;
