within Electrical.Drives;
block ContinuousSpeedControl "Continuous PI speed controller with torque limit and back calculation"
  extends SpeedControl;
  SI.Torque x(start = 0, fixed = true) "Integral part";
protected
  SI.Torque v "Torque before the limit";
equation
  assert(K_p > 0 and K_i >= 0 and T_max > 0, "K_p and T_max must be positive, K_i not negative");
  v = K_p*(w_ref - w) + x;
  T = min(max(v, -T_max), T_max);
  der(x) = K_i*(w_ref - w) + K_i/K_p*(T - v);
  annotation(Documentation(info = "<html><p><code>T = K_p e + x</code> with limits, <code>dx/dt = K_i (e + (T - v)/K_p)</code>: back calculation keeps the integral part from winding up. Interchangeable with <code>SampledSpeedControl</code>. Source: K. J. Astrom and T. Hagglund, PID Controllers, 1995, section 3.5.</p></html>"));
end ContinuousSpeedControl;
