within Electrical.Drives;
model SampledCurrentControl "Sampled field-oriented current control with voltage limit: what is computed in one period takes effect in the next"
  extends CurrentControl(u_d(start = 0, fixed = true), u_q(start = 0, fixed = true));
  parameter SI.Time T_s(min = 1e-6, max = 1e-2, nominal = 1e-4) = 31.25e-6 "Sampling period: half a carrier period of SwitchingInverter, so that the ripple of the current is not seen";
  discrete SI.Voltage x_d(start = 0, fixed = true) "Integral part of the d axis";
  discrete SI.Voltage x_q(start = 0, fixed = true) "Integral part of the q axis";
protected
  discrete SI.Voltage v_d(start = 0, fixed = true) "Command of the d axis before the limit";
  discrete SI.Voltage v_q(start = 0, fixed = true) "Command of the q axis before the limit";
  discrete SI.Voltage c_d(start = 0, fixed = true) "Computed for the next period, d axis";
  discrete SI.Voltage c_q(start = 0, fixed = true) "Computed for the next period, q axis";
  discrete Real k(unit = "1", start = 1, fixed = true) "Share that the limit leaves";
equation
  assert(T_s > 0 and T_s*w_c < 1, "The sampling period T_s must be positive and shorter than 1/w_c");
  when sample(0, T_s) then
    v_d = K_d*(i_d_ref - i_d) + pre(x_d) - p*w*L*i_q;
    v_q = K_p*(i_q_ref - i_q) + pre(x_q) + p*w*(L_d*i_d + psi_f);
    k = min(1, u_max/max(sqrt(v_d^2 + v_q^2), 1e-3));
    x_d = pre(x_d) + T_s*(K_i*(i_d_ref - i_d) + (k - 1)*v_d*w_c);
    x_q = pre(x_q) + T_s*(K_i*(i_q_ref - i_q) + (k - 1)*v_q*w_c);
    c_d = k*v_d;
    c_q = k*v_q;
    u_d = pre(c_d);
    u_q = pre(c_q);
  end when;
  annotation(Documentation(info = "<html><p>The law of <code>ContinuousCurrentControl</code> every <code>T_s</code>, the integral part by Euler's rule, with the same back calculation at the voltage limit. The voltages of one sample act one period later and are held in rotor axes, one and a half periods of delay in all: the inverter turns them to the angle at which they act.</p>
<p>Valid while <code>w_c T_s</code> stays below about 0.3: above, the delay makes the loop ring. Source: B.-H. Bae and S.-K. Sul, IEEE Trans. Ind. Appl. 39 (2003) 802, for the delay.</p></html>"));
end SampledCurrentControl;
