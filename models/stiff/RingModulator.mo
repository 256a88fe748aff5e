model RingModulator "Modulator of four diodes in a ring, mixing a low and a high frequency"
  import Modelica.Units.SI;
  constant SI.Capacitance C = 1.6e-8;
  parameter SI.Capacitance C_s = 2e-12 "Of the diodes";
  constant SI.Capacitance C_p = 1e-8;
  constant SI.Resistance R = 25e3;
  constant SI.Resistance R_p = 50;
  constant SI.Inductance L_h = 4.45;
  constant SI.Inductance L_s1 = 2e-3;
  constant SI.Inductance L_s2 = 5e-4;
  constant SI.Inductance L_s3 = 5e-4;
  constant SI.Resistance R_g1 = 36.3;
  constant SI.Resistance R_g2 = 17.3;
  constant SI.Resistance R_g3 = 17.3;
  constant SI.Resistance R_i = 50;
  constant SI.Resistance R_c = 600;
  constant SI.Current gamma = 40.67286402e-9 "Reverse current of the diodes";
  constant Real delta(unit = "1/V") = 17.7493332;
  SI.Voltage U[7](each start = 0, each fixed = true, each nominal = 0.1) "Voltages of the capacitors";
  SI.Current I[8](
    each start = 0, each fixed = true, nominal = {1e-6, 1e-7, 1e-3, 1e-3, 1e-3, 1e-3, 1e-4, 1e-4}) "Currents of the coils";
  SI.Voltage U_1 "Low frequency";
  SI.Voltage U_2 "High frequency";
protected
  SI.Voltage u[4] "Voltages of the diodes";
  SI.Current q[4] "Currents of the diodes";
equation
  U_1 = 0.5*sin(2e3*Modelica.Constants.pi*time);
  U_2 = 2*sin(2e4*Modelica.Constants.pi*time);
  u[1] = U[3] - U[5] - U[7] - U_2;
  u[2] = -U[4] + U[6] - U[7] - U_2;
  u[3] = U[4] + U[5] + U[7] + U_2;
  u[4] = -U[3] - U[6] + U[7] + U_2;
  for k in 1:4 loop
    q[k] = gamma*(exp(delta*u[k]) - 1);
  end for;
  C*der(U[1]) = I[1] - 0.5*I[3] + 0.5*I[4] + I[7] - U[1]/R;
  C*der(U[2]) = I[2] - 0.5*I[5] + 0.5*I[6] + I[8] - U[2]/R;
  C_s*der(U[3]) = I[3] - q[1] + q[4];
  C_s*der(U[4]) = -I[4] + q[2] - q[3];
  C_s*der(U[5]) = I[5] + q[1] - q[3];
  C_s*der(U[6]) = -I[6] - q[2] + q[4];
  C_p*der(U[7]) = -U[7]/R_p + q[1] + q[2] - q[3] - q[4];
  L_h*der(I[1]) = -U[1];
  L_h*der(I[2]) = -U[2];
  L_s2*der(I[3]) = 0.5*U[1] - U[3] - R_g2*I[3];
  L_s3*der(I[4]) = -0.5*U[1] + U[4] - R_g3*I[4];
  L_s2*der(I[5]) = 0.5*U[2] - U[5] - R_g2*I[5];
  L_s3*der(I[6]) = -0.5*U[2] + U[6] - R_g3*I[6];
  L_s1*der(I[7]) = -U[1] + U_1 - (R_i + R_g1)*I[7];
  L_s1*der(I[8]) = -U[2] - (R_c + R_g1)*I[8];
  annotation(
    experiment(StartTime = 0, StopTime = 1e-3, Interval = 2e-6, Tolerance = 1e-6),
    Documentation(info = "<html><p>Source: E. H. Horneber 1976; Test Set for IVP Solvers, problem RINGMOD, with the published values at 1 ms.</p></html>"));
end RingModulator;
