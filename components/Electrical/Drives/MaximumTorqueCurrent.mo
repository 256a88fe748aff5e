within Electrical.Drives;
model MaximumTorqueCurrent "Most torque per current, field weakening at the limit of the voltage"
  extends CurrentCommand;
  parameter SI.Current i_max(min = 1e-3, max = 1e5, nominal = 10) = 10 "Greatest current of a phase, peak";
  parameter Real reserve(unit = "1", min = 0.5, max = 0.99) = 0.95 "Share of the voltage at which the field is weakened; the rest moves the currents";
  parameter SI.Time T_i(min = 1e-4, max = 10, nominal = 1e-2) = 5e-3 "Time in which the field is weakened";
  SI.Current i_w(start = 0, fixed = true, nominal = 10) "Current that weakens the field, negative";
  SI.Current i_m(nominal = 10) "Current of the d axis for most torque per current";
  SI.Voltage u(nominal = 100) "Voltage commanded, peak";
protected
  parameter SI.Inductance dL = L_q - L_d "Saliency";
  parameter SI.Voltage u_max = V_dc/sqrt(3) "Greatest voltage of a phase, peak";
  parameter SI.Current i_low = -min(i_max, psi_f/L_d) "Least current of the d axis: the field is gone, or all current is used";
  SI.Current i_q_max(nominal = 10) "What the d axis leaves of i_max";
  SI.Current slack(nominal = 10) "Voltage that is left, as a current";
equation
  assert(i_max > 0, "The greatest current i_max must be positive");
  i_m = -2*dL*i_q^2/(psi_f + sqrt(psi_f^2 + 4*dL^2*i_q^2));
  u = sqrt(u_d^2 + u_q^2);
  slack = (reserve*u_max - u)/u_max*i_max;
  der(i_w) = noEvent(max(min(slack, -i_w), i_low - i_m - i_w))/T_i;
  i_d_ref = max(i_m + i_w, i_low);
  i_q_max = sqrt(max(i_max^2 - i_d_ref^2, 0));
  i_q_ref = min(max(T/(1.5*p*(psi_f - dL*i_d_ref)), -i_q_max), i_q_max);
  annotation(Documentation(info = "<html>
<p>Below the base speed the current of the d axis is that of most torque per current, <code>i_d = -2 dL i_q^2/(psi_f + sqrt(psi_f^2 + 4 dL^2 i_q^2))</code> with <code>dL = L_q - L_d</code>, from the measured <code>i_q</code>: 0 without saliency. Where the commanded voltage passes <code>reserve V_dc/sqrt(3)</code>, an integrator adds a negative current and so weakens the field, as far as the field is gone (<code>-psi_f/L_d</code>) or all current is used; it goes back as voltage is left. The current of the q axis makes the torque with what is left of <code>i_max</code>.</p>
<p>At full command the torque over speed is that of the current circle as far as the voltage ellipse, then of their crossing, where <code>(L_q i_q)^2 + (L_d i_d + psi_f)^2 = (u/(p w))^2</code> (less the drop of the resistance). Motors with <code>psi_f/L_d &lt; i_max</code> follow the ellipse alone beyond that; their torque is limited by the voltage of the current control. Source: S. Morimoto, Y. Takeda, T. Hirasa, K. Taniguchi, IEEE Trans. Ind. Appl. 26 (1990) 866.</p></html>"));
end MaximumTorqueCurrent;
