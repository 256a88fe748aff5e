within Electrical.Drives;
block VfInverter "Inverter with voltage in proportion to frequency"
  Interfaces.RealInput f_ref(unit = "Hz") "Command of frequency";
  Interfaces.RealOutput f(unit = "Hz") "Frequency";
  Interfaces.RealOutput U(unit = "V") "Voltage of a phase, rms";
  parameter Real k_f(unit = "V/Hz", min = 0) = 7.6 "Line voltage over frequency";
  parameter SI.Voltage U_b(min = 0) = 0 "Boost of the line voltage, some 10 V";
  parameter SI.Voltage U_max(min = 1) = 380 "Greatest line voltage";
  parameter SI.Frequency f_boost(min = 1e-6) = 0.5 "Frequency over which the boost sets in";
equation
  assert(U_max > 0, "U_max must be positive");
  f = f_ref;
  U = min(U_b*Smooth.step(abs(f)/f_boost) + k_f*abs(f), U_max)/sqrt(3);
  annotation(Documentation(info = "<html><p><code>U_LL = min(U_b + k_f f, U_max)</code>: constant flux but for the drop at the stator resistance, which the boost covers at low frequency. Switching is left out. Slip compensation: <code>VfSlipInverter</code>. Source: W. Leonhard, Control of Electrical Drives, 2001.</p></html>"));
end VfInverter;
