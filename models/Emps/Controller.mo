within Emps;
block Controller "Position controller of the bench, continuous"
  parameter Real k_p(unit = "1/s", min = 0) = 160.18 "Gain of the position loop";
  parameter Real k_v(unit = "V.s/m", min = 0) = 243.45 "Gain of the velocity loop";
  parameter SI.Voltage u_max(min = 0) = 10 "Limit";
  parameter SI.Time T_f(min = 1e-6) = 1.5e-3 "Delay of the velocity: half a sample each for difference, mean and hold";
  parameter SI.Position q_start = 0 "Position at the start";
  Interfaces.RealInput q_ref(unit = "m", nominal = 0.1) "Reference";
  Interfaces.RealInput q(unit = "m", nominal = 0.1) "Measured position";
  Interfaces.RealInput pulse(unit = "V") "Voltage added behind the limit";
  Interfaces.RealOutput u(unit = "V", nominal = 1) "Voltage";
  SI.Position q_f(start = q_start, fixed = true, nominal = 0.1) "Position behind the filter";
  SI.Velocity v_f(nominal = 0.1) "Its rate, the velocity that the controller sees";
equation
  assert(T_f > 0, "T_f must be positive");
  v_f = (q - q_f)/T_f;
  der(q_f) = v_f;
  u = smooth(0, min(max(k_p*k_v*(q_ref - q) - k_v*v_f, -u_max), u_max)) + pulse;
  annotation(Documentation(info = "<html><p>The sampled controller of <code>ClosedLoop</code> with its delays as one lag, so that the loop is smooth between the samples of a recording.</p></html>"));
end Controller;
