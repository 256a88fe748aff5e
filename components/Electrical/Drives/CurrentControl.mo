within Electrical.Drives;
model CurrentControl "Field-oriented current control with voltage limit and dead time of the inverter"
  Interfaces.RealInput i_d_ref(unit = "A") "Command of the d axis";
  Interfaces.RealInput i_q_ref(unit = "A") "Command of the q axis";
  Interfaces.RealInput i_d(unit = "A") "Measured current of the d axis";
  Interfaces.RealInput i_q(unit = "A") "Measured current of the q axis";
  Interfaces.RealInput w(unit = "rad/s") "Measured speed of the shaft";
  Interfaces.RealOutput u_d(unit = "V") "Voltage of the d axis";
  Interfaces.RealOutput u_q(unit = "V") "Voltage of the q axis";
  parameter Integer p(min = 1) = 8 "Pole pairs";
  parameter SI.Resistance R_s(min = 0) = 0.176 "Phase resistance known to the controller";
  parameter SI.Inductance L(min = 1e-9) = 0.314e-3 "Inductance known to the controller";
  parameter SI.MagneticFlux psi_f(min = 0) = 0.08 "Flux linkage known to the controller";
  parameter SI.AngularFrequency w_c(min = 1) = 2*Modelica.Constants.pi*500 "Bandwidth of the current loop";
  parameter SI.Voltage V_dc(min = 1) = 540 "Voltage of the DC link";
  parameter SI.Voltage u_dt(min = 0) = 0 "Voltage lost by dead time, peak";
  parameter SI.Current i_w(min = 1e-6) = 0.05 "Current over which the dead time changes sign";
  SI.Voltage x_d(start = 0, fixed = true) "Integral part of the d axis";
  SI.Voltage x_q(start = 0, fixed = true) "Integral part of the q axis";
protected
  parameter SI.Resistance K_p = L*w_c "Gain";
  parameter Real K_i(unit = "V/(A.s)") = R_s*w_c "Integral gain";
  parameter SI.Voltage u_max = V_dc/sqrt(3) "Greatest amplitude";
  SI.Voltage v_d "Command of the d axis before the limit";
  SI.Voltage v_q "Command of the q axis before the limit";
  Real k(unit = "1") "Share that the limit leaves";
equation
  assert(V_dc > 0 and w_c > 0, "V_dc and the bandwidth w_c must be positive");
  v_d = K_p*(i_d_ref - i_d) + x_d - p*w*L*i_q;
  v_q = K_p*(i_q_ref - i_q) + x_q + p*w*(L*i_d + psi_f);
  k = min(1, u_max/max(sqrt(v_d^2 + v_q^2), 1e-3));
  u_d = k*v_d - u_dt*Smooth.sgn(i_d, i_w);
  u_q = k*v_q - u_dt*Smooth.sgn(i_q, i_w);
  der(x_d) = K_i*(i_d_ref - i_d) + (k - 1)*v_d*w_c;
  der(x_q) = K_i*(i_q_ref - i_q) + (k - 1)*v_q*w_c;
  annotation(Documentation(info = "<html><p>PI controllers whose zero cancels the electrical time constant, so that the closed loop is a lag of 1/w_c, with decoupling and back calculation at the voltage limit <code>V_dc/sqrt(3)</code>. Source: R. Krishnan, Permanent Magnet Synchronous and Brushless DC Motor Drives, 2010.</p></html>"));
end CurrentControl;
