within Electrical.Drives;
model ContinuousCurrentControl "Continuous field-oriented current control with voltage limit"
  extends CurrentControl;
  SI.Voltage x_d(start = 0, fixed = true) "Integral part of the d axis";
  SI.Voltage x_q(start = 0, fixed = true) "Integral part of the q axis";
protected
  SI.Voltage v_d "Command of the d axis before the limit";
  SI.Voltage v_q "Command of the q axis before the limit";
  Real k(unit = "1") "Share that the limit leaves";
equation
  v_d = K_d*(i_d_ref - i_d) + x_d - p*w*L*i_q;
  v_q = K_p*(i_q_ref - i_q) + x_q + p*w*(L_d*i_d + psi_f);
  k = min(1, u_max/max(sqrt(v_d^2 + v_q^2), 1e-3));
  u_d = k*v_d;
  u_q = k*v_q;
  der(x_d) = K_i*(i_d_ref - i_d) + (k - 1)*v_d*w_c;
  der(x_q) = K_i*(i_q_ref - i_q) + (k - 1)*v_q*w_c;
  annotation(Documentation(info = "<html><p><code>v_d = L_d w_c e_d + x_d - p w L i_q</code>, <code>v_q = L w_c e_q + x_q + p w (L_d i_d + psi_f)</code>, <code>dx/dt = R_s w_c e + w_c (u - v)</code>, where u is v shortened to the voltage limit. Interchangeable with <code>SampledCurrentControl</code>.</p>
<p>Source: R. Krishnan, Permanent Magnet Synchronous and Brushless DC Motor Drives, 2010.</p></html>"));
end ContinuousCurrentControl;
