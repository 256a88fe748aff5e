within Electrical.Drives;
model FluxVectorDrive "Induction motor under sensorless flux vector control: rotor flux, slip and the estimated speed"
  Interfaces.RealInput w_ref(unit = "rad/s") "Command of speed";
  Interfaces.RotationalFlange flange "Shaft";
  parameter Integer p(min = 1, max = 100) = 2 "Pole pairs";
  parameter SI.Resistance R_r(min = 1e-6, max = 1e3, nominal = 0.1) = 0.228 "Rotor resistance, on the stator side";
  parameter SI.Inductance L_lr(min = 1e-9, max = 10, nominal = 1e-3) = 0.302/(120*Modelica.Constants.pi) "Leakage inductance of the rotor, on the stator side";
  parameter SI.Inductance L_m(min = 1e-9, max = 100, nominal = 1e-2) = 13.08/(120*Modelica.Constants.pi) "Magnetizing inductance";
  parameter Real R_hat(unit = "1", min = 0.1, max = 10) = 1 "Rotor resistance that the controller assumes, over the true one";
  parameter SI.MagneticFlux psi_ref(min = 1e-3, max = 100) = 0.95 "Command of rotor flux, peak";
  parameter Real K_p(unit = "N.m.s/rad", min = 1e-3) = 20 "Gain of the speed controller";
  parameter Real K_i(unit = "N.m/rad", min = 0) = 150 "Integral gain";
  parameter SI.Time tau_T(min = 1e-6) = 10e-3 "Time constant of the current loops";
  parameter SI.Time tau_w(min = 1e-6) = 50e-3 "Time constant of the estimated speed";
  parameter SI.Torque T_max(min = 1e-6) = 300 "Greatest torque";
  parameter Boolean voltageLimit = false "true: the inverter gives no more than U_max; the flux weakens and the torque ends where it must" annotation(Evaluate = true);
  parameter SI.Voltage U_max(min = 1, max = 1e5, nominal = 100) = 460*sqrt(2/3) "Greatest phase voltage, peak";
  parameter Real weakening(unit = "1", min = 0.1, max = 0.99) = 0.9 "Share of U_max that the flux may take; the rest drives the torque";
  parameter SI.Resistance R_s(min = 0, max = 1e3, nominal = 0.1) = 0.087 "Stator resistance, for the voltage";
  parameter SI.Inductance L_ls(min = 1e-9, max = 10, nominal = 1e-3) = L_lr "Leakage inductance of the stator, for the voltage";
  parameter SI.AngularVelocity w_start = 0 "Estimated speed at the start";
  SI.AngularVelocity w(nominal = 100) "Speed";
  SI.AngularVelocity w_e(nominal = 100) "Electrical angular velocity of the flux";
  SI.AngularVelocity w_sl(nominal = 10) "Electrical slip";
  SI.AngularVelocity w_est(start = w_start, fixed = true, nominal = 100) "Estimated speed";
  SI.Current i_d(start = psi_ref/L_m, fixed = true, nominal = 10) "Current that makes the flux, peak";
  SI.Current i_q(start = 0, fixed = true, nominal = 10) "Current that makes the torque, peak";
  SI.MagneticFlux psi_r(start = psi_ref, fixed = true) "Rotor flux";
  SI.Torque x(start = 0, fixed = true, nominal = 100) "Integral part";
  SI.Torque T_e(nominal = 100) "Torque of the motor";
  SI.Voltage u_s(nominal = 100) "Phase voltage that the currents need once they stand still, peak";
protected
  parameter SI.Inductance L_s = L_ls + L_m "Inductance of the stator";
  parameter SI.Inductance L_t = L_s - L_m^2/(L_lr + L_m) "Transient inductance of the stator";
  constant SI.Resistance Z_0 = 1e-6 "Keeps the impedance from 0 at rest where there is no stator resistance";
  SI.Resistance Z_q(nominal = 1) "Impedance of the current that makes the torque";
  SI.Voltage U_q(nominal = 100) "What the other current leaves of the voltage along that impedance";
  SI.Voltage U_c(nominal = 100) "What it takes of it there";
  SI.MagneticFlux psi_cmd(nominal = 1) "Command of rotor flux in use";
  SI.Torque T_low(nominal = 100) "Least torque";
  SI.Torque T_high(nominal = 100) "Greatest torque";
  parameter SI.Inductance L_r = L_lr + L_m "Inductance of the rotor";
  SI.Torque T_ref(nominal = 100) "Command of torque";
  SI.Torque T_free(nominal = 100) "The same before its limit";
  SI.AngularVelocity w_hat(nominal = 100) "Estimated speed before its filter";
equation
  assert(R_r > 0 and L_m > 0 and psi_ref > 0, "R_r, L_m and psi_ref must be positive");
  assert(K_p > 0 and tau_T > 0 and tau_w > 0 and T_max > 0, "K_p, time constants and T_max must be positive");
  w = der(flange.phi);
  T_free = K_p*(w_ref - w_est) + x;
  if voltageLimit then
    psi_cmd = min(psi_ref, weakening*U_max*L_m/(L_s*Smooth.mag(w_e, 1) + R_s + 1e-9));
    T_low = max(-T_max, 1.5*p*L_m/L_r*psi_cmd*(-U_c - U_q)/Z_q);
    T_high = min(T_max, 1.5*p*L_m/L_r*psi_cmd*(-U_c + U_q)/Z_q);
  else
    psi_cmd = psi_ref;
    T_low = -T_max;
    T_high = T_max;
  end if;
  Z_q = sqrt(R_s^2 + (w_e*L_t)^2 + Z_0^2);
  U_c = R_s*w_e*(L_s - L_t)*i_d/Z_q;
  U_q = sqrt(noEvent(max(U_max^2 - ((R_s*i_d)^2 + (w_e*L_s*i_d)^2 - U_c^2), 1e-6*U_max^2)));
  u_s = sqrt((R_s*i_d - w_e*L_t*i_q)^2 + (R_s*i_q + w_e*L_s*i_d)^2);
  T_ref = min(max(T_free, T_low), T_high);
  der(x) = K_i*(w_ref - w_est) + K_i/K_p*(T_ref - T_free);
  tau_T*der(i_d) = psi_cmd/L_m - i_d;
  tau_T*der(i_q) = T_ref*L_r/(1.5*p*L_m*psi_cmd) - i_q;
  der(psi_r) = R_r/L_r*(L_m*i_d - psi_r);
  w_sl = R_r/L_r*L_m*i_q/psi_r;
  w_e = p*w + w_sl;
  w_hat = (w_e - R_hat*w_sl)/p;
  tau_w*der(w_est) = w_hat - w_est;
  T_e = 1.5*p*L_m/L_r*psi_r*i_q;
  flange.tau = -T_e;
  annotation(Documentation(info = "<html>
<p>In axes of the rotor flux: <code>dpsi/dt = R_r/L_r (L_m i_d - psi)</code>, <code>w_sl = R_r L_m i_q/(L_r psi)</code>, <code>T_e = 3/2 p L_m/L_r psi i_q</code>; the currents follow their commands with <code>tau_T</code>. The controller knows the speed of the flux and subtracts the slip that it computes with its own rotor resistance: an error of that resistance
leaves the speed off by <code>(R_hat - 1) w_sl/p</code>, and the filter of the estimate, <code>tau_w</code>, is what makes the loop oscillate.</p>
<p>The axes are taken as found exactly; the drift of the flux estimate at very low frequency is left out, so that it holds above some 2 Hz. Without <code>voltageLimit</code> the inverter has any voltage: that holds up to the nominal speed.</p>
<p><b>Voltage limit</b>: at rest of the currents <code>u_d = R_s i_d - w_e L_t i_q</code>, <code>u_q = R_s i_q + w_e L_s i_d</code> with the transient inductance <code>L_t = L_s - L_m^2/L_r</code>. The flux weakens with <code>weakening U_max L_m/(L_s w_e)</code>, and the torque is held to the current for which <code>u_d^2 + u_q^2 = U_max^2</code>; the integral part of the controller stops with it.</p>
<p> With <code>R_hat = 1</code> and constant flux it is <code>SensorlessVectorDrive</code>, which has the same ports. Source: P. Vas, Sensorless Vector and Direct Torque Control, 1998; defaults: 50 hp motor of Krause.</p></html>"));
end FluxVectorDrive;
