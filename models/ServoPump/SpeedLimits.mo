within ServoPump;
partial model SpeedLimits "Speeds that pump, motor, voltage, torque and cavitation allow at a load pressure"
  parameter SI.Pressure p_low(min = 5e4, nominal = 5e5) = 5e5 "Pressure of the low side";
  parameter Real N_pump(unit = "rev/min", min = 1) = 3000 "Rated speed of the pump";
  parameter Real N_motor(unit = "rev/min", min = 1) = 3000 "Rated speed of the motor";
  parameter SI.Torque T_max(min = 0) = 3.18 "Continuous torque of the motor";
  parameter SI.Voltage U_max(min = 0) = 540/sqrt(3) "Greatest phase voltage, peak";
  parameter SI.Resistance R_s(min = 0) = 0.176 "Resistance of a phase";
  parameter SI.Inductance L(min = 0) = 0.314e-3 "Inductance of a phase";
  parameter SI.MagneticFlux psi(min = 1e-4) = 0.08 "Flux of the magnets";
  parameter Integer pairs(min = 1) = 8 "Pole pairs";
  parameter Real R_suction(unit = "Pa.s2/m6", min = 0) = 1e14 "Drop of the suction line over the square of the flow";
  parameter SI.Pressure p_cav(min = 0, nominal = 1e5) = 5e4 "Least pressure at the inlet";
  BenchPump pump(compression = false) "Pump";
  SI.Pressure dp(nominal = 1e7) "Load pressure";
  Real N_U(unit = "rev/min", nominal = 1e3) "Limit by the voltage";
  Real N_T(unit = "rev/min", nominal = 1e3) "Limit by the torque, negative where it does not suffice at any speed";
  Real N_cav(unit = "rev/min", nominal = 1e3) "Limit by cavitation at the inlet";
  Real N_s(unit = "rev/min", nominal = 1e3) "Begin of the saturation zone: the least of the limits";
protected
  constant Real pi = Modelica.Constants.pi;
  parameter Real D(unit = "m3/rad") = pump.V/(2*pi) "Displacement per radian";
  SI.Torque T(nominal = 1) "Torque at the voltage limit";
  SI.Current i_q(nominal = 1) "Current there";
  SI.AngularVelocity w_U(nominal = 400, start = 400) "Speed there";
equation
  T = D*dp + pump.T_c + pump.k_p*D*dp + pump.b*w_U;
  T = 1.5*pairs*psi*i_q;
  (R_s*i_q + pairs*w_U*psi)^2 + (pairs*w_U*L*i_q)^2 = U_max^2;
  N_U = Modelica.Units.Conversions.to_rpm(w_U);
  N_T = Modelica.Units.Conversions.to_rpm((T_max - pump.T_c - (1 + pump.k_p)*D*dp)/pump.b);
  N_cav = 60*sqrt((p_low - p_cav)/R_suction)/pump.V;
  N_s = max(min(min(min(N_pump, N_motor), min(N_U, N_cav)), N_T), 0);
  annotation(Documentation(info = "<html><p>Voltage: <code>(R_s i_q + p w psi)^2 + (p w L i_q)^2 = U_max^2</code>; torque: <code>D dp + T_loss(w) = T_max</code>; cavitation: <code>p_low - R_suction Q^2 = p_cav</code>. The suction line is assumed, the paper gives none.</p></html>"));
end SpeedLimits;
