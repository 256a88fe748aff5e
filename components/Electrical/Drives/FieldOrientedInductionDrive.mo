within Electrical.Drives;
model FieldOrientedInductionDrive "Induction motor under indirect rotor-field-oriented control: current loops, flux observer, speed measured or observed"
  Interfaces.RealInput w_ref(unit = "rad/s") "Command of speed";
  Interfaces.RotationalFlange flange "Shaft; the inertia of the rotor is a component of its own";
  parameter Boolean sensorless = false "true: the speed is observed from voltages and currents" annotation(Evaluate = true);
  parameter Integer p(min = 1, max = 100) = 2 "Pole pairs";
  parameter SI.Resistance R_s(min = 1e-6, max = 1e3, nominal = 0.1) = 0.087 "Stator resistance";
  parameter SI.Resistance R_r(min = 1e-6, max = 1e3, nominal = 0.1) = 0.228 "Rotor resistance, on the stator side";
  parameter SI.Inductance L_ls(min = 1e-9, max = 10, nominal = 1e-3) = 0.302/(120*Modelica.Constants.pi) "Leakage inductance of the stator";
  parameter SI.Inductance L_lr(min = 1e-9, max = 10, nominal = 1e-3) = 0.302/(120*Modelica.Constants.pi) "Leakage inductance of the rotor, on the stator side";
  parameter SI.Inductance L_m(min = 1e-9, max = 100, nominal = 1e-2) = 13.08/(120*Modelica.Constants.pi) "Magnetizing inductance";
  parameter Real k_Rr(unit = "1", min = 0.1, max = 10) = 1 "Rotor resistance that the controller assumes, over the true one";
  parameter Real k_Rs(unit = "1", min = 0.1, max = 10) = 1 "Stator resistance that the observer assumes, over the true one";
  parameter SI.MagneticFlux psi_ref(min = 1e-3, max = 100) = 0.95 "Command of rotor flux, peak";
  parameter SI.Voltage U_max(min = 1, max = 1e5, nominal = 100) = 460*sqrt(2/3) "Greatest phase voltage, peak";
  parameter SI.Current I_max(min = 1e-3, max = 1e6, nominal = 100) = 200 "Greatest phase current, peak";
  parameter SI.Torque T_max(min = 1e-6) = 300 "Greatest torque that is commanded";
  parameter Real K_p(unit = "N.m.s/rad", min = 1e-9) = 20 "Gain of the speed controller";
  parameter Real K_i(unit = "N.m/rad", min = 0) = 150 "Integral gain";
  parameter SI.AngularFrequency w_c(min = 1) = 2*Modelica.Constants.pi*100 "Bandwidth of the current loops";
  parameter Real weakening(unit = "1", min = 0.1, max = 0.99) = 0.9 "Share of U_max that the flux may take";
  parameter SI.AngularFrequency w_o(min = 0.1) = 10 "Frequency below which the observer trusts the currents, above which the voltages";
  parameter Real K_o(unit = "rad/s", min = 0) = 50 "Gain of the observed speed";
  parameter Real T_o(unit = "s", min = 1e-4) = 0.02 "Its integral time";
  parameter SI.Time tau_w(min = 1e-6) = 5e-3 "Time constant of the filter of the speed";
  parameter SI.AngularVelocity w_start = 0 "Speed that the controller takes for the motor's at the start";
  parameter Boolean steady = false "true: currents, fluxes and controllers stand at the start" annotation(Evaluate = true);
  SI.AngularVelocity w(nominal = 100) "Speed";
  SI.AngularVelocity w_est(start = w_start, fixed = not steady, nominal = 100) "Speed that the controller knows";
  SI.AngularVelocity w_e(nominal = 100) "Angular velocity of the controller's axes";
  SI.MagneticFlux psi_ds(start = psi_ref*(L_ls + L_m)/L_m, fixed = not steady) "Flux of the stator, d axis of the controller, peak";
  SI.MagneticFlux psi_qs(start = 0, fixed = not steady) "Flux of the stator, q axis";
  SI.MagneticFlux psi_dr(start = psi_ref, fixed = not steady) "Flux of the rotor, d axis";
  SI.MagneticFlux psi_qr(start = 0, fixed = not steady) "Flux of the rotor, q axis: 0 where the controller is right";
  SI.MagneticFlux psi_hat(start = psi_ref, fixed = not steady) "Flux of the rotor that the controller takes for its own";
  SI.Current i_d(nominal = 10) "Current of the stator, d axis, peak";
  SI.Current i_q(nominal = 10) "Current of the stator, q axis, peak";
  SI.Voltage u(nominal = 100) "Voltage, peak";
  SI.Torque T_ref(nominal = 100) "Torque commanded";
  SI.Torque T_e(nominal = 100) "Torque of the motor";
  SI.Power P_cu(nominal = 100) "Copper loss of stator and rotor";
protected
  parameter SI.Inductance L_s = L_ls + L_m "Inductance of the stator";
  parameter SI.Inductance L_r = L_lr + L_m "Inductance of the rotor";
  parameter SI.Inductance L_t = L_s - L_m^2/L_r "Transient inductance of the stator";
  parameter Real det(unit = "H2") = L_s*L_r - L_m^2 "Determinant";
  parameter SI.Resistance R_t = R_s + R_r*(L_m/L_r)^2 "Resistance that the current loops see";
  constant SI.MagneticFlux psi_low = 1e-3 "Keeps the slip finite without flux";
  SI.Torque x(start = 0, fixed = not steady, nominal = 100) "Integral part of the speed controller";
  SI.Voltage x_d(start = R_s*psi_ref/L_m, fixed = not steady, nominal = 10) "Integral part of the d axis";
  SI.Voltage x_q(start = 0, fixed = not steady, nominal = 10) "Integral part of the q axis";
  SI.MagneticFlux s_d(start = psi_ref*(L_ls + L_m)/L_m, fixed = not steady) "Observed flux of the stator, d axis";
  SI.MagneticFlux s_q(start = 0, fixed = not steady) "Observed flux of the stator, q axis";
  SI.AngularVelocity w_i(start = w_start, fixed = not steady, nominal = 100) "Integral part of the observed speed";
  SI.AngularVelocity w_now(nominal = 100) "Speed before its filter";
  SI.AngularVelocity w_sl(nominal = 10) "Slip that the controller commands";
  SI.MagneticFlux psi_cmd "Command of flux in use";
  SI.Current i_dr(nominal = 10) "Current of the rotor, d axis";
  SI.Current i_qr(nominal = 10) "Current of the rotor, q axis";
  SI.Current i_d_ref(nominal = 10) "Command of the d axis";
  SI.Current i_q_ref(nominal = 10) "Command of the q axis";
  SI.Current i_q_max(nominal = 10) "What the d axis leaves of I_max";
  SI.Torque T_free(nominal = 100) "Torque command before its limit";
  SI.Voltage v_d(nominal = 100) "Voltage command before the limit, d axis";
  SI.Voltage v_q(nominal = 100) "Voltage command before the limit, q axis";
  SI.Voltage u_d(nominal = 100) "Voltage, d axis";
  SI.Voltage u_q(nominal = 100) "Voltage, q axis";
  parameter SI.Voltage U_d = U_max*sqrt(1 - 1e-4) "Limit of the d axis; a hundredth of U_max is left to the other, so that its limit has a slope";
  SI.Voltage U_q(nominal = 100) "What the d axis leaves of U_max";
  SI.Voltage E(nominal = 100) "Voltage that the flux asks for, q axis";
  constant SI.Resistance Z_0 = 1e-6 "Keeps the impedance from 0";
  SI.Resistance X(nominal = 1) "Transient reactance";
  SI.Resistance Z(nominal = 1) "Transient impedance";
  SI.Current i_mid(nominal = 10) "Current of the q axis that needs least voltage";
  SI.Current i_way(nominal = 10) "Way from there to the limit of the voltage";
  SI.Current i_low(nominal = 10) "Least current of the q axis that voltage and I_max allow";
  SI.Current i_high(nominal = 10) "Greatest current of the q axis that they allow";
  Real k_T(unit = "N.m/A", nominal = 1) "Torque per current of the q axis";
initial equation
  if steady then
    {der(psi_ds), der(psi_qs), der(psi_dr), der(psi_qr), der(psi_hat)} = zeros(5);
    {der(w_est), der(x), der(x_d), der(x_q), der(s_d), der(s_q), der(w_i)} = zeros(7);
  end if;
equation
  assert(R_r > 0 and L_m > 0 and L_ls > 0 and L_lr > 0, "Rotor resistance and inductances must be positive");
  assert(psi_ref > 0 and psi_ref/L_m < I_max, "The flux psi_ref takes more than I_max");
  // motor, in the axes of the controller
  w = der(flange.phi);
  i_d = (L_r*psi_ds - L_m*psi_dr)/det;
  i_q = (L_r*psi_qs - L_m*psi_qr)/det;
  i_dr = (L_s*psi_dr - L_m*psi_ds)/det;
  i_qr = (L_s*psi_qr - L_m*psi_qs)/det;
  der(psi_ds) = u_d - R_s*i_d + w_e*psi_qs;
  der(psi_qs) = u_q - R_s*i_q - w_e*psi_ds;
  der(psi_dr) = -R_r*i_dr + (w_e - p*w)*psi_qr;
  der(psi_qr) = -R_r*i_qr - (w_e - p*w)*psi_dr;
  T_e = 1.5*p*(psi_ds*i_q - psi_qs*i_d);
  P_cu = 1.5*(R_s*(i_d^2 + i_q^2) + R_r*(i_dr^2 + i_qr^2));
  flange.tau = -T_e;
  // flux and axes
  der(psi_hat) = k_Rr*R_r/L_r*(L_m*i_d - psi_hat);
  w_sl = k_Rr*R_r/L_r*L_m*i_q/max(psi_hat, psi_low);
  w_e = p*w_now + w_sl;
  // speed
  der(s_d) = u_d - k_Rs*R_s*i_d + w_e*s_q + w_o*(L_m/L_r*psi_hat + L_t*i_d - s_d);
  der(s_q) = u_q - k_Rs*R_s*i_q - w_e*s_d + w_o*(L_t*i_q - s_q);
  if sensorless then
    der(w_i) = K_o/T_o*(s_q - L_t*i_q)/psi_ref;
    w_now = w_i + K_o*(s_q - L_t*i_q)/psi_ref;
  else
    der(w_i) = 0;
    w_now = w;
  end if;
  tau_w*der(w_est) = w_now - w_est;
  T_free = K_p*(w_ref - w_est) + x;
  T_ref = homotopy(min(max(T_free, max(-T_max, k_T*i_low)), min(T_max, k_T*i_high)), min(max(T_free, -T_max), T_max));
  der(x) = K_i*(w_ref - w_est) + K_i/K_p*(T_ref - T_free);
  // currents
  psi_cmd = min(psi_ref, weakening*U_max*L_m/(L_s*Smooth.mag(w_e, 1)));
  i_d_ref = psi_cmd/L_m;
  i_q_max = sqrt(max(I_max^2 - i_d_ref^2, 0));
  E = w_e*(L_t*i_d + L_m/L_r*psi_hat);
  X = w_e*L_t;
  Z = sqrt(R_s^2 + X^2 + Z_0^2);
  i_mid = R_s*(X*i_d - E)/Z^2;
  i_way = sqrt(noEvent(max((U_max^2 - (R_s*i_d)^2 - E^2)/Z^2 + i_mid^2, (1e-3*I_max)^2)));
  i_low = min(max(i_mid - i_way, -i_q_max), i_q_max);
  i_high = min(max(i_mid + i_way, -i_q_max), i_q_max);
  k_T = 1.5*p*L_m/L_r*max(psi_hat, psi_low);
  i_q_ref = min(max(T_ref/k_T, -i_q_max), i_q_max);
  v_d = L_t*w_c*(i_d_ref - i_d) + x_d - w_e*L_t*i_q;
  v_q = L_t*w_c*(i_q_ref - i_q) + x_q + E;
  // a steady start is one below the limits of the voltage: with them, it is not found
  u_d = if initial() then (if steady then v_d else min(max(v_d, -U_d), U_d)) else min(max(v_d, -U_d), U_d);
  U_q = sqrt(noEvent(max(U_max^2 - u_d^2, U_max^2 - U_d^2)));
  u_q = if initial() then (if steady then v_q else min(max(v_q, -U_q), U_q)) else min(max(v_q, -U_q), U_q);
  u = sqrt(u_d^2 + u_q^2);
  der(x_d) = R_t*w_c*(i_d_ref - i_d) + w_c*(u_d - v_d);
  der(x_q) = R_t*w_c*(i_q_ref - i_q) + w_c*(u_q - v_q);
  annotation(Documentation(info = "<html>
<p>The motor is that of <code>InductionMotor</code>, in axes that turn with <code>w_e = p w + w_sl</code>. The controller takes the flux of the rotor to lie along d: <code>d psi/dt = R_r/L_r (L_m i_d - psi)</code>, <code>w_sl = R_r L_m i_q/(L_r psi)</code>, with the resistance <code>k_Rr R_r</code> that it assumes. Current loops of bandwidth <code>w_c</code> with decoupling; the flux weakens beyond the speed at which it takes <code>weakening U_max</code>.</p>
<p><b>Voltage limit</b>: the flux comes first. The d axis has all of <code>U_max</code> (but for 5e-5 of it), the q axis <code>sqrt(U_max^2 - u_d^2)</code>, and the integral part of each axis follows what its own limit leaves, so that lack of voltage for the torque never weakens or strengthens the flux. The torque commanded is held to the currents for which <code>(R_s i_d - X i_q)^2 + (R_s i_q + E)^2 = U_max^2</code> (<code>X = w_e L_t</code>, <code>E = w_e (L_t i_d + psi L_m/L_r)</code>) and to what the d axis leaves of <code>I_max</code>, and the integral part of the speed controller stops with it: a step of the speed ends where a slow ramp does. With a wrong <code>k_Rr</code> the true flux is not the commanded one, and the voltage may end at a lower speed.</p>
<p><b>Detuning</b>: with currents held, the slip is <code>k_Rr</code> times too large, and the torque is <code>3/2 p L_m^2/L_r |i|^2 s/(1 + s^2)</code> with <code>s = k_Rr i_q/i_d</code>, instead of <code>3/2 p L_m^2/L_r i_d i_q</code>; the flux leaves the d axis (<code>psi_qr</code>).</p>
<p><b>Without a speed sensor</b> the flux of the stator is integrated from the voltages, held by the currents below <code>w_o</code>; its part across the axes, which should be 0, turns the axes until it is: a PI controller gives the speed. Near standstill the voltages say little (an error of <code>k_Rs</code> makes the speed drift there). Source: C. Schauder, IEEE Trans. Ind. Appl. 28 (1992) 1054; W. Leonhard, Control of Electrical Drives, chapter 12; priority of the flux at the limit of the voltage: R. De Doncker, D. W. J. Pulle, A. Veltman, Advanced Electrical Drives, 2011. Inverter, saturation and iron loss are left out.</p></html>"));
end FieldOrientedInductionDrive;
