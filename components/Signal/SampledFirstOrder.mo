within Signal;
block SampledFirstOrder "Sampled lag of first order, exact for a held input"
  extends Bases.Sampled(y(start = y_start, fixed = true));
  parameter SI.Time T(min = 1e-9) = 1 "Time constant";
  parameter Real k = 1 "Gain";
  parameter Real y_start = 0 "Output before the first sample";
protected
  parameter Real a(unit = "1") = exp(-samplePeriod/T) "Weight of the last output";
equation
  assert(T > 0, "The time constant T must be positive");
  when tick then
    y = a*pre(y) + (1 - a)*k*u;
  end when;
  annotation(Documentation(info = "<html><p><code>y_k = a y_(k-1) + (1 - a) k u_k</code> with <code>a = exp(-period/T)</code>: has the step response of a lag of first order at the samples.</p></html>"));
end SampledFirstOrder;
