within Electrical.Drives;
model SwitchingInverter "Inverter with its switches: triangular carrier sampled at both ends, dead time, every edge an event"
  extends Inverter;
  Boolean high[3](each start = true, each fixed = true) "true: the phase lies at the positive pin";
protected
  parameter SI.Time T_h = 1/(2*f_s) "Half a carrier period";
  discrete Real u[3](each unit = "V", each start = 0, each fixed = true) "Commands of the phases";
  discrete Real m[3](each unit = "1", each start = 0, each fixed = true) "Commands over half the DC link, -1 to 1";
  discrete SI.Time t_edge[3](each start = 0, each fixed = true) "When the carrier meets the command";
  discrete SI.Time t_leg[3](each start = 0, each fixed = true) "When the phase follows";
  discrete SI.Angle theta_m(start = 0, fixed = true) "Electrical angle in the middle of the half period";
  Boolean rising(start = false, fixed = true) "true: the carrier rises";
  Boolean passed[3](each start = true, each fixed = true) "true: the carrier has met the command";
  Boolean upper[3](each start = true, each fixed = true) "true: the upper switch is commanded";
  SI.Voltage leg[3] "Voltages of the phases against the middle of the DC link";
equation
  when sample(0, T_h) then
    rising = not pre(rising);
    theta_m = p*(phi + w*T_h/2);
    for j in 1:3 loop
      u[j] = k*(u_d*cos(theta_m - (j - 1)*third) - u_q*sin(theta_m - (j - 1)*third));
      m[j] = min(max((2*u[j] - max(u) - min(u))/v_dc, -1), 1);
      t_edge[j] = time + T_h*(1 + (if rising then m[j] else -m[j]))/2;
    end for;
  end when;
  for j in 1:3 loop
    passed[j] = time >= t_edge[j];
    upper[j] = if rising then not passed[j] else passed[j];
    when change(upper[j]) then
      t_leg[j] = time + (if real and (if upper[j] then i[j] > 0 else i[j] < 0) then T_d else 0);
    end when;
    high[j] = if time >= t_leg[j] then upper[j] else not upper[j];
    leg[j] = (if high[j] then v_dc/2 else -v_dc/2) - drop[j];
  end for;
  v_d = 2/3*sum(leg[j]*cos(theta - (j - 1)*third) for j in 1:3);
  v_q = -2/3*sum(leg[j]*sin(theta - (j - 1)*third) for j in 1:3);
  i_dc = sum((if high[j] then i[j] else 0) for j in 1:3);
  annotation(Documentation(info = "<html><p>At each end of the carrier the commands are taken, turned to the middle of the half period, and shifted together so that the whole DC link is used (<code>u_0 = -(max u + min u)/2</code>). The upper switch is on while the command lies above the carrier. In the dead time both switches are off and the current flows through a diode: with a current out of the phase it stays low before a rising edge, with a current into it it stays high before a falling one. The sign of the current counts at the beginning of the dead time.</p>
<p>Some 10 to 14 events a carrier period. Interchangeable with <code>AveragedInverter</code>. Source: D. G. Holmes and T. A. Lipo, Pulse Width Modulation for Power Converters, 2003.</p></html>"));
end SwitchingInverter;
