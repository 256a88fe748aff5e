within Electrical.Drives;
partial model Inverter "Three-phase inverter that feeds a motor in rotor axes from a DC link"
  Interfaces.Pin dc_p "Positive pin of the DC link";
  Interfaces.Pin dc_n "Negative pin of the DC link";
  Interfaces.RealInput u_d(unit = "V") "Commanded voltage of the d axis, peak";
  Interfaces.RealInput u_q(unit = "V") "Commanded voltage of the q axis, peak";
  Interfaces.RealInput i_d(unit = "A") "Current of the motor, d axis, peak";
  Interfaces.RealInput i_q(unit = "A") "Current of the motor, q axis, peak";
  Interfaces.RealInput phi(unit = "rad") "Angle of the shaft";
  Interfaces.RealInput w(unit = "rad/s") "Speed of the shaft";
  Interfaces.RealOutput v_d(unit = "V") "Voltage at the motor, d axis, peak";
  Interfaces.RealOutput v_q(unit = "V") "Voltage at the motor, q axis, peak";
  parameter Integer p(min = 1) = 8 "Pole pairs";
  parameter SI.Frequency f_s(min = 100, max = 1e6, nominal = 1e4) = 16e3 "Frequency of the carrier";
  parameter Boolean real = false "true: with dead time and voltage drops of the switches" annotation(Evaluate = true);
  parameter SI.Time T_d(min = 0, max = 1e-4, nominal = 1e-6) = 0.5e-6 "Dead time";
  parameter SI.Voltage V_f(min = 0, max = 10, nominal = 1) = 0 "Voltage drop of a switch or diode, independent of the current";
  parameter SI.Resistance R_on(min = 0, max = 10, nominal = 1e-2) = 0 "Resistance of a switch or diode";
  parameter SI.Current i_w(min = 1e-6, max = 10) = 0.05 "Current over which V_f changes sign";
  SI.Voltage v_dc(nominal = 500) "Voltage of the DC link";
  SI.Current i_dc "Current out of the DC link";
  SI.Power lossPower(nominal = 10) "Power lost in the switches";
protected
  constant SI.Angle third = 2*Modelica.Constants.pi/3;
  SI.Angle theta "Electrical angle";
  SI.Current i[3] "Currents of the phases, out of the inverter";
  SI.Voltage drop[3] "Voltage drops of the phases";
  Real k(unit = "1") "Share of the command that the DC link allows";
equation
  assert(f_s > 0 and T_d >= 0 and T_d*f_s < 0.2, "The carrier frequency must be positive, the dead time a small part of its period");
  v_dc = dc_p.v - dc_n.v;
  dc_p.i = i_dc;
  dc_n.i = -i_dc;
  k = min(1, v_dc/sqrt(3)/max(sqrt(u_d^2 + u_q^2), 1e-3));
  theta = p*phi;
  for j in 1:3 loop
    i[j] = i_d*cos(theta - (j - 1)*third) - i_q*sin(theta - (j - 1)*third);
    drop[j] = if real then V_f*Smooth.sgn(i[j], i_w) + R_on*i[j] else 0;
  end for;
  lossPower = drop*i;
  annotation(Documentation(info = "<html><p>Voltages longer than <code>v_dc/sqrt(3)</code> are shortened, their direction kept: the circle inside the hexagon of the switches. The DC link gives what the motor takes and what is lost in the switches. Forms with equal ports: <code>AveragedInverter</code>, <code>SwitchingInverter</code>.</p></html>"));
end Inverter;
