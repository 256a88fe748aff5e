within Signal;
block MovingAverage "Mean of a signal over the last time T"
  extends Bases.OneToOne;
  parameter SI.Time T(min = 1e-6, max = 1e9, nominal = 0.1) = 0.1 "Time over which the mean is taken";
  parameter Real u_start = 0 "Input before the start";
  Real x(start = 0, fixed = true) "Integral of the input less u_start";
equation
  assert(T > 0, "The time T of the mean must be positive");
  der(x) = u - u_start;
  y = u_start + (x - delay(x, T))/T;
  annotation(Documentation(info = "<html><p><code>y(t) = 1/T integral of u from t - T to t</code>. Before the start the input counts as <code>u_start</code>. Removes every frequency <code>n/T</code> and delays by <code>T/2</code>. The integral grows with a mean of the input other than <code>u_start</code>: over a run of more than a million T, digits are lost. Where a model is made linear or fitted, take a low pass, which has no delay: <code>Butterworth</code>.</p>
<p>Source: K. J. Astrom and B. Wittenmark, Computer-Controlled Systems, 1997, section 7.4 (filters of the mean).</p></html>"));
end MovingAverage;
