within Signal;
block SampledPI "Sampled PI controller with limited output; the integral stops at the limits"
  parameter SI.Time samplePeriod(min = 1e-9, nominal = 1e-3) = 1e-3 "Sampling period";
  parameter Real k = 1 "Gain";
  parameter SI.Time T_i(min = 1e-9) = 1 "Time of the integrator";
  parameter Real yMax = 1 "Upper limit";
  parameter Real yMin = -yMax "Lower limit";
  parameter Real x_start = 0 "Integral part at the start";
  Interfaces.RealInput u_s "Set point";
  Interfaces.RealInput u_m "Measured value";
  Interfaces.RealOutput y(start = 0, fixed = true) "Output, held between samples";
  discrete Real x(start = x_start, fixed = true) "Integral part";
  discrete Real e(start = 0, fixed = true) "Control error at the last sample";
equation
  assert(samplePeriod > 0 and T_i > 0, "The sampling period and T_i must be positive");
  assert(yMax > yMin, "yMax must lie above yMin");
  when sample(0, samplePeriod) then
    e = u_s - u_m;
    x = min(max(pre(x) + k*samplePeriod/T_i*e, yMin - k*e), yMax - k*e);
    y = min(max(k*e + x, yMin), yMax);
  end when;
  annotation(Documentation(info = "<html><p><code>y = k e + x</code>, <code>x_k = x_(k-1) + k period/T_i e</code>, carried out at the samples; the integral part is kept such that y stays within its limits (anti-windup).</p></html>"));
end SampledPI;
