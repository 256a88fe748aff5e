within Electrical.Drives;
block VfSlipInverter "Inverter with voltage in proportion to frequency, boost and slip compensation"
  Interfaces.RealInput f_ref(unit = "Hz") "Command of frequency";
  Interfaces.RealInput T(unit = "N.m") "Torque of the motor as the inverter estimates it";
  Interfaces.RealOutput f(unit = "Hz") "Frequency";
  Interfaces.RealOutput U(unit = "V") "Voltage of a phase, rms";
  parameter Real k_f(unit = "V/Hz", min = 1e-6) = 7.6 "Line voltage over frequency";
  parameter SI.Voltage U_b(min = 0) = 10 "Boost of the line voltage";
  parameter SI.Voltage U_max(min = 1) = 380 "Greatest line voltage";
  parameter SI.Frequency f_boost(min = 1e-6) = 0.5 "Frequency over which the boost sets in";
  parameter Real k_sl(unit = "Hz/(N.m)", min = 0) = 0.01 "Frequency added over torque";
  parameter SI.Time tau(min = 1e-6) = 0.1 "Time constant of the compensation";
  parameter SI.Frequency f_max(min = 0.1) = 5 "Greatest compensation";
  SI.Frequency f_sl(start = 0, fixed = true) "Compensation";
equation
  assert(U_max > 0 and tau > 0, "U_max and tau must be positive");
  tau*der(f_sl) = min(max(k_sl*T, -f_max), f_max) - f_sl;
  f = f_ref + f_sl;
  U = min(U_b*Smooth.step(abs(f)/f_boost) + k_f*abs(f), U_max)/sqrt(3);
  annotation(Documentation(info = "<html><p>As <code>VfInverter</code>, with <code>f = f_ref + k_sl T</code> behind a lag: the drop of speed under load shrinks, and so does the damping that it gives. <code>k_sl = 1/(2 pi K_m/p)</code> with the stiffness <code>K_m</code> of the motor compensates the slip fully; real inverters stop at 80 % of that. Valid for slow changes of the torque, against <code>tau</code>. Source: W. Leonhard, Control of Electrical Drives, 2001.</p></html>"));
end VfSlipInverter;
