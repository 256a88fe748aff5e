model TransistorAmplifier "Amplifier with two transistors, index 1"
  import Modelica.Units.SI;
  constant SI.Voltage U_b = 6 "Supply";
  constant SI.Voltage U_F = 0.026 "Thermal voltage";
  constant Real alpha = 0.99 "Current amplification";
  constant SI.Current beta = 1e-6 "Reverse current";
  constant SI.Resistance R_0 = 1000 "Resistance of the source";
  constant SI.Resistance R = 9000 "All other resistances";
  constant SI.Capacitance C[5] = {1e-6, 2e-6, 3e-6, 4e-6, 5e-6} "Capacitances";
  SI.Voltage U_e "Input";
  SI.Voltage y[8](start = {0, 3, 3, 6, 3, 3, 6, 0}) "Potentials of the nodes";
  SI.Voltage u[5](start = {-3, 3, 3, 3, 6}, each fixed = true) "Voltages of the capacitors";
  SI.Current i[5](each nominal = 1e-4) "Currents of the capacitors";
protected
  SI.Current g_1 "Current of the first base-emitter junction";
  SI.Current g_2 "Current of the second base-emitter junction";
equation
  U_e = 0.1*sin(200*Modelica.Constants.pi*time);
  u[1] = y[1] - y[2];
  u[2] = y[3];
  u[3] = y[4] - y[5];
  u[4] = y[6];
  u[5] = y[7] - y[8];
  for k in 1:5 loop
    C[k]*der(u[k]) = i[k];
  end for;
  g_1 = beta*(exp((y[2] - y[3])/U_F) - 1);
  g_2 = beta*(exp((y[5] - y[6])/U_F) - 1);
  i[1] = (U_e - y[1])/R_0;
  i[1] = y[2]*(1/R + 1/R) - U_b/R - (alpha - 1)*g_1;
  i[2] = g_1 - y[3]/R;
  i[3] = (U_b - y[4])/R - alpha*g_1;
  i[3] = y[5]*(1/R + 1/R) - U_b/R - (alpha - 1)*g_2;
  i[4] = g_2 - y[6]/R;
  i[5] = (U_b - y[7])/R - alpha*g_2;
  i[5] = y[8]/R;
  annotation(
    experiment(StartTime = 0, StopTime = 0.2, Interval = 0.0005, Tolerance = 1e-6),
    Documentation(info = "<html><p>Published at 0.2 s: y = (-0.5562145012262709e-2, 3.006522471903042, 2.849958788608128, 2.926422536206241, 2.704617865010554, 2.761837778393145, 4.770927631616772, 1.236995868091548).
Written with the capacitor voltages as states, so that the singular mass matrix of the original (index 1) appears as algebraic equations. Source: P. Rentrop, M. Roche, G. Steinebach 1989; Test Set for IVP Solvers, problem TRANSAMP.</p></html>"));
end TransistorAmplifier;
