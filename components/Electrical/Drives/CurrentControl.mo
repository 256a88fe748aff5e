within Electrical.Drives;
partial model CurrentControl "Field-oriented current control: voltages commanded for commanded currents"
  Interfaces.RealInput i_d_ref(unit = "A") "Command of the d axis";
  Interfaces.RealInput i_q_ref(unit = "A") "Command of the q axis";
  Interfaces.RealInput i_d(unit = "A") "Measured current of the d axis";
  Interfaces.RealInput i_q(unit = "A") "Measured current of the q axis";
  Interfaces.RealInput w(unit = "rad/s") "Measured speed of the shaft";
  Interfaces.RealOutput u_d(unit = "V") "Commanded voltage of the d axis";
  Interfaces.RealOutput u_q(unit = "V") "Commanded voltage of the q axis";
  parameter Integer p(min = 1) = 8 "Pole pairs";
  parameter SI.Resistance R_s(min = 0) = 0.176 "Phase resistance known to the controller";
  parameter SI.Inductance L(min = 1e-9) = 0.314e-3 "Inductance of the q axis known to the controller";
  parameter SI.Inductance L_d(min = 1e-9) = L "Inductance of the d axis known to the controller";
  parameter SI.MagneticFlux psi_f(min = 0) = 0.08 "Flux linkage known to the controller";
  parameter SI.AngularFrequency w_c(min = 1) = 2*Modelica.Constants.pi*500 "Bandwidth of the current loop";
  parameter SI.Voltage V_dc(min = 1) = 540 "Voltage of the DC link known to the controller";
protected
  parameter SI.Resistance K_p = L*w_c "Gain of the q axis";
  parameter SI.Resistance K_d = L_d*w_c "Gain of the d axis";
  parameter Real K_i(unit = "V/(A.s)") = R_s*w_c "Integral gain";
  parameter SI.Voltage u_max = V_dc/sqrt(3) "Greatest amplitude";
equation
  assert(V_dc > 0 and w_c > 0, "V_dc and the bandwidth w_c must be positive");
  annotation(Documentation(info = "<html><p>PI controllers whose zero cancels the electrical time constant, so that the closed loop is a lag of 1/w_c, with decoupling of the axes and back calculation at the voltage limit <code>V_dc/sqrt(3)</code>. Forms with equal ports: <code>ContinuousCurrentControl</code>, <code>SampledCurrentControl</code>.</p></html>"));
end CurrentControl;
