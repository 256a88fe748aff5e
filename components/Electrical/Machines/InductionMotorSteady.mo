within Electrical.Machines;
model InductionMotorSteady "Induction motor by its steady-state equivalent circuit"
  Interfaces.RealInput f(unit = "Hz") "Frequency of the supply";
  Interfaces.RealInput U(unit = "V") "Voltage of a phase, rms";
  Interfaces.RotationalFlange flange "Shaft; the inertia of the rotor is a component of its own";
  parameter Integer p(min = 1, max = 100) = 2 "Pole pairs";
  parameter SI.Resistance R_s(min = 1e-6, max = 1e3, nominal = 0.1) = 0.087 "Stator resistance at T_ref";
  parameter SI.Resistance R_r(min = 1e-6, max = 1e3, nominal = 0.1) = 0.228 "Rotor resistance at T_ref, on the stator side";
  parameter SI.Inductance L_ls(min = 1e-9, max = 10, nominal = 1e-3) = 0.302/(120*Modelica.Constants.pi) "Leakage inductance of the stator";
  parameter SI.Inductance L_lr(min = 1e-9, max = 10, nominal = 1e-3) = 0.302/(120*Modelica.Constants.pi) "Leakage inductance of the rotor, on the stator side";
  parameter SI.Inductance L_m(min = 1e-9, max = 100, nominal = 1e-2) = 13.08/(120*Modelica.Constants.pi) "Magnetizing inductance";
  parameter SI.RotationalDampingConstant B(min = 0) = 0 "Friction and windage";
  parameter SI.TemperatureDifference dT(min = -200, max = 300) = 0 "Windings above T_ref, without heatPort";
  parameter Boolean useHeatPort = false "true: temperature and losses go through heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(T = T_w, Q_flow = -(P_cu + P_mech)) if useHeatPort "Windings, and the heat of friction and windage";
  parameter SI.Temperature T_ref(min = 200, max = 500) = 293.15 "Temperature of R_s and R_r";
  parameter SI.LinearTemperatureCoefficient alpha(min = 0, max = 0.02) = 0.0039 "Temperature coefficient of the resistances";
  SI.AngularVelocity w(nominal = 100) "Speed";
  SI.AngularVelocity w_e(nominal = 100) "Electrical angular velocity of the supply";
  SI.AngularVelocity w_sl(nominal = 10) "Electrical slip";
  SI.Current I_1(nominal = 10) "Stator current, rms";
  SI.Torque T_e(nominal = 100) "Electromagnetic torque";
  SI.Power P_cu(nominal = 100) "Copper loss of stator and rotor";
  SI.Power P_mech(nominal = 10) "Friction and windage";
  SI.Temperature T_w(nominal = 300) "Temperature of the windings";
protected
  SI.Resistance R_1 "Stator resistance";
  SI.Resistance R_2 "Rotor resistance";
  parameter SI.Inductance L_r = L_lr + L_m "Inductance of the rotor";
  SI.Resistance a "Reactance of the rotor loop at slip frequency";
  Real N_re(unit = "Ohm2") "Stator loop times rotor loop, real part";
  Real N_im(unit = "Ohm2") "Stator loop times rotor loop, imaginary part";
  Real N_2(unit = "Ohm4") "Square of its magnitude";
equation
  assert(p >= 1, "The number of pole pairs p must be at least 1");
  assert(R_r > 0 and L_m > 0, "Rotor resistance and magnetizing inductance must be positive");
  assert(alpha*(T_w - T_ref) > -1, "Cold windings keep some resistance: alpha holds near T_ref only");
  if not useHeatPort then
    T_w = T_ref + dT;
  end if;
  R_1 = R_s*(1 + alpha*(T_w - T_ref));
  R_2 = R_r*(1 + alpha*(T_w - T_ref));
  w = der(flange.phi);
  w_e = 2*Modelica.Constants.pi*f;
  w_sl = w_e - p*w;
  a = w_sl*L_r;
  N_re = R_1*R_2 - w_e*(L_ls + L_m)*a + w_e*L_m*w_sl*L_m;
  N_im = R_1*a + w_e*(L_ls + L_m)*R_2;
  N_2 = N_re^2 + N_im^2;
  T_e = 3*p*U^2*L_m^2*R_2*w_sl/N_2;
  I_1 = U*sqrt((R_2^2 + a^2)/N_2);
  P_cu = 3*R_1*I_1^2 + T_e*w_sl/p;
  P_mech = B*w^2;
  flange.tau = -T_e + B*w;
  annotation(Documentation(info = "<html><p>T circuit: stator <code>R_s + j w_e L_ls</code>, magnetizing <code>j w_e L_m</code>, rotor <code>R_r w_e/w_sl + j w_e L_lr</code>, multiplied through with the slip so that nothing is singular at no load. <code>T_e = 3 p I_2^2 R_r/w_sl</code>. Copper loss and friction with windage, <code>B w^2</code>, go to <code>heatPort</code>.
The rotor loses the share of the slip in the power of the air gap. No electrical transients. Source: P. C. Krause, Analysis of Electric Machinery, chapter 4. Valid where speed and supply change slowly against the leakage time constants (some 10 ms).</p></html>"));
end InductionMotorSteady;
