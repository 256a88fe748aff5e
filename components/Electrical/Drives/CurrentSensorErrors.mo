within Electrical.Drives;
block CurrentSensorErrors "Currents in rotor axes as two phase sensors with offset and gain errors see them"
  Interfaces.RealInput i_d(unit = "A") "True current of the d axis";
  Interfaces.RealInput i_q(unit = "A") "True current of the q axis";
  Interfaces.RealInput phi(unit = "rad") "Angle of the shaft";
  Interfaces.RealOutput j_d(unit = "A") "Measured current of the d axis";
  Interfaces.RealOutput j_q(unit = "A") "Measured current of the q axis";
  parameter Integer p(min = 1) = 8 "Pole pairs";
  parameter SI.Current offset_a = 0 "Offset of the sensor of phase a";
  parameter SI.Current offset_b = 0 "Offset of the sensor of phase b";
  parameter Real gain_a(unit = "1", min = 0.1, max = 10) = 1 "Gain of the sensor of phase a";
  parameter Real gain_b(unit = "1", min = 0.1, max = 10) = 1 "Gain of the sensor of phase b";
protected
  SI.Angle theta "Electrical angle";
  SI.Current i_a "Measured current of phase a";
  SI.Current i_b "Measured current of phase b";
  SI.Current alpha "First component in stator axes";
  SI.Current beta "Second component in stator axes";
equation
  theta = p*phi;
  i_a = gain_a*(i_d*cos(theta) - i_q*sin(theta)) + offset_a;
  i_b = gain_b*(i_d*cos(theta - 2*Modelica.Constants.pi/3) - i_q*sin(theta - 2*Modelica.Constants.pi/3)) + offset_b;
  alpha = i_a;
  beta = (i_a + 2*i_b)/sqrt(3);
  j_d = alpha*cos(theta) + beta*sin(theta);
  j_q = -alpha*sin(theta) + beta*cos(theta);
  annotation(Documentation(info = "<html><p>The third phase is computed from the two measured ones. An offset makes a torque ripple at the electrical frequency, unequal gains at twice that, in proportion to the load. Put between the motor's currents and <code>ContinuousCurrentControl</code>. Source: D.-W. Chung and S.-K. Sul, IEEE Trans. Ind. Appl. 34 (1998) 1000.</p></html>"));
end CurrentSensorErrors;
