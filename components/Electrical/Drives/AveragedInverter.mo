within Electrical.Drives;
model AveragedInverter "Inverter averaged over a carrier period: voltage limit, and the means of dead time and drops"
  extends Inverter;
protected
  SI.Voltage error[3] "What dead time and drops take from the phases";
equation
  for j in 1:3 loop
    error[j] = if real then v_dc*T_d*f_s*Smooth.sgn(i[j], i_w) + drop[j] else 0;
  end for;
  v_d = k*u_d - 2/3*sum(error[j]*cos(theta - (j - 1)*third) for j in 1:3);
  v_q = k*u_q + 2/3*sum(error[j]*sin(theta - (j - 1)*third) for j in 1:3);
  v_dc*i_dc = 1.5*(v_d*i_d + v_q*i_q) + lossPower;
  annotation(Documentation(info = "<html><p>Of a carrier period the dead time takes <code>v_dc T_d f_s</code> from each phase, against its current: a distortion of the sixth order in rotor axes, that costs no power. Drops, <code>V_f sign(i) + R_on i</code>, do. Means of voltages and currents agree with <code>SwitchingInverter</code>; its ripple is missing.</p>
<p>Valid for speeds far below the carrier, and for currents whose ripple is small against them: where the ripple takes the current through zero the dead time takes less. Source: D. G. Holmes and T. A. Lipo, Pulse Width Modulation for Power Converters, 2003.</p></html>"));
end AveragedInverter;
