within Electrical.Drives;
block SampledSpeedControl "Sampled PI speed controller with torque limit, output held"
  extends SpeedControl(T(fixed = true));
  parameter SI.Time T_s(min = 1e-6) = 0.625e-3 "Sampling period";
  discrete SI.Torque x(start = 0, fixed = true) "Integral part";
  discrete SI.AngularVelocity e(start = 0, fixed = true) "Control error";
equation
  assert(T_s > 0 and T_max > 0, "T_s and T_max must be positive");
  when sample(0, T_s) then
    e = w_ref - w;
    x = min(max(pre(x) + K_i*T_s*e, -T_max), T_max);
    T = min(max(K_p*e + x, -T_max), T_max);
  end when;
  annotation(Documentation(info = "<html><p>As <code>ContinuousSpeedControl</code>, carried out every <code>T_s</code>, the output held in between; integral part and output are limited. Valid while the loop is slower than some ten samples.</p></html>"));
end SampledSpeedControl;
