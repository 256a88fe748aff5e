within Emps;
model ClosedLoop "The axis in its sampled position loop"
  parameter SI.Mass M(min = 1, max = 1000, nominal = 100) = 95.1089 "Moving mass, motor included";
  parameter SI.TranslationalDampingConstant F_v(min = 0, max = 1e4, nominal = 200) = 203.5034 "Viscous friction";
  parameter SI.Force F_c(min = 0, max = 1e3, nominal = 20) = 20.3935 "Dry friction";
  parameter SI.Force F_0(min = -1e3, max = 1e3, nominal = 3) = -3.1648 "Force offset, against the motor";
  parameter Real k_p(unit = "1/s") = 160.18 "Gain of the position loop";
  parameter Real k_v(unit = "V.s/m") = 243.45 "Gain of the velocity loop";
  parameter Real k_F(unit = "N/V") = 35.15065 "Force of the motor over control voltage";
  parameter SI.Voltage u_max(min = 0) = 10 "Limit of the controller";
  parameter SI.Time T_s(min = 1e-6) = 1e-3 "Sampling period";
  parameter SI.Position q_start = 0 "Position at the start";
  parameter SI.Velocity v_start = 0 "Velocity at the start, and at the samples before it";
  Interfaces.RealInput q_ref(unit = "m", nominal = 0.1) "Reference position";
  Interfaces.RealInput pulse(unit = "V", start = 0) "Voltage added to the controller's";
  Axis axis(M = M, F_v = F_v, F_c = F_c, F_0 = F_0, q_start = q_start, v_start = v_start) "Axis";
  Interfaces.RealOutput q(unit = "m", nominal = 0.1) "Position";
  Interfaces.RealOutput v(unit = "m/s", nominal = 0.1) "Velocity";
  discrete SI.Force F(start = 0, fixed = true, nominal = 100) "Force of the motor";
  discrete SI.Voltage u(start = 0, fixed = true) "Control voltage";
protected
  discrete SI.Position q_k(start = q_start - v_start*T_s, fixed = true) "Position at the last sample";
  discrete SI.Position q_f(start = q_start - 1.5*v_start*T_s, fixed = true) "Mean of the last two samples";
equation
  when sample(0, T_s) then
    q_k = q;
    q_f = (q_k + pre(q_k))/2;
    u = min(max(k_p*k_v*(q_ref - q_k) - k_v*(q_f - pre(q_f))/T_s, -u_max), u_max) + pulse;
    F = k_F*u;
  end when;
  axis.F = F;
  q = axis.q;
  v = axis.v;
  annotation(
    experiment(StartTime = 0, StopTime = 24.84, Interval = 0.001, Tolerance = 1e-6),
    Documentation(info = "<html><p><code>u = k_p k_v (q_ref - q) - k_v dq_f</code>, limited to u_max, with dq_f the backward difference of the mean of the last two positions, at 1 kHz; the force is held between samples. <code>pulse</code> adds a disturbance behind the limit. With the published values
and the recording's start, which is in motion (7.45 um, 5.65 mm/s), the force differs from the measured one by 4.6 % (rms; published: 4.5 %), without dry friction by 38 %.</p></html>"));
end ClosedLoop;
