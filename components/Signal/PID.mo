within Signal;
block PID "PID controller in ideal form: weights of the set point, limits of output and rate, back calculation against windup"
  parameter Real k = 1 "Gain";
  parameter SI.Time T_i(min = 1e-9, max = 1e9, nominal = 1) = 1 "Time of the integrator";
  parameter SI.Time T_d(min = 0, max = 1e9, nominal = 0.1) = 0.1 "Time of the derivative; 0: PI controller";
  parameter SI.Time T_f(min = 1e-9, max = 1e9, nominal = 0.01) = max(T_d/10, 1e-6) "Time constant of the filter of the derivative";
  parameter Real b(unit = "1", min = 0, max = 1) = 1 "Weight of the set point in the proportional part";
  parameter Real c(unit = "1", min = 0, max = 1) = 0 "Weight of the set point in the derivative part";
  parameter SI.Time T_t(min = 1e-9, max = 1e9, nominal = 1) = T_i "Time in which the integral part follows the limits";
  parameter Real yMax = 1 "Upper limit";
  parameter Real yMin = -yMax "Lower limit";
  parameter Boolean limitRate = false "true: the rate of the output is limited too" annotation(Evaluate = true);
  parameter Real rateMax(unit = "1/s", min = 1e-60) = 10 "Greatest rate of the output, both ways, where limitRate";
  parameter Real x_start = 0 "Integral part at the start";
  parameter Real xd_start = 0 "Filtered c u_s - u_m at the start";
  Interfaces.RealInput u_s "Set point";
  Interfaces.RealInput u_m "Measured value";
  Interfaces.RealOutput y "Output";
  Real x(start = x_start, fixed = true) "Integral part";
  Derivative derivative(final k = k*T_d, final T = T_f, final x_start = xd_start) "Derivative part";
  Limiter limiter(final uMax = yMax, final uMin = yMin) "Limits of the output";
  RateLimiter slew(final rising = rateMax, final y_start = min(max(x_start, yMin), yMax)) if limitRate "Limit of the rate";
protected
  Real v "Output before the limits";
equation
  assert(T_i > 0 and T_t > 0 and T_f > 0 and T_d >= 0, "The times T_i, T_t and T_f must be positive, T_d not negative");
  assert(yMax > yMin, "yMax must lie above yMin");
  derivative.u = c*u_s - u_m;
  v = k*(b*u_s - u_m) + x + derivative.y;
  limiter.u = v;
  der(x) = k/T_i*(u_s - u_m) + (y - v)/T_t;
  connect(limiter.y, slew.u);
  if limitRate then
    connect(slew.y, y);
  else
    connect(limiter.y, y);
  end if;
  annotation(Documentation(info = "<html><p><code>y = k (b u_s - u_m + 1/(T_i s) (u_s - u_m) + T_d s/(T_f s + 1) (c u_s - u_m))</code>, held within <code>yMin</code> and <code>yMax</code> and, where asked for, within <code>rateMax</code>. With <code>b = c = 1</code> the ideal form <code>k (1 + 1/(T_i s) + T_d s/(T_f s + 1))</code> on the error.</p>
<p>While a limit holds, the integral part is led back with the time <code>T_t</code>, so that it does not wind up. Take <code>T_t</code> between <code>T_d</code> and <code>T_i</code>. <code>T_f</code> is <code>T_d/N</code> with N from 5 to 20. Reaching a limit is an event. The set point of a run that starts away from 0 belongs into <code>x_start</code> and <code>xd_start</code>.</p>
<p>Source: K. J. Astrom and T. Hagglund, PID Controllers, 1995, sections 3.4 and 3.5.</p></html>"));
end PID;
