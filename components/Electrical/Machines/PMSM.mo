within Electrical.Machines;
model PMSM "Permanent magnet synchronous motor in rotor axes (dq, amplitude invariant)"
  Interfaces.RealInput u_d(unit = "V") "Voltage of the d axis, peak";
  Interfaces.RealInput u_q(unit = "V") "Voltage of the q axis, peak";
  Interfaces.RealOutput i_d(unit = "A", start = 0, fixed = true) "Current of the d axis, peak";
  Interfaces.RealOutput i_q(unit = "A", start = 0, fixed = true) "Current of the q axis, peak";
  Interfaces.RotationalFlange flange "Shaft; the inertia of the rotor is a component of its own";
  parameter Integer p(min = 1, max = 100) = 8 "Pole pairs";
  parameter SI.MagneticFlux psi_f(min = 1e-6, max = 100, nominal = 0.1) = 0.08 "Flux linkage of the magnets at T_ref, peak";
  parameter SI.Resistance R_s(min = 0, max = 1e3, nominal = 1) = 0.176 "Phase resistance at T_ref";
  parameter SI.Inductance L_d(min = 1e-9, max = 10, nominal = 1e-3) = 0.314e-3 "Inductance of the d axis";
  parameter SI.Inductance L_q(min = 1e-9, max = 10, nominal = 1e-3) = 0.314e-3 "Inductance of the q axis";
  parameter SI.Power P_fe(min = 0, nominal = 10) = 0 "Iron loss at w_nom";
  parameter SI.AngularVelocity w_nom(min = 1) = 314.159 "Nominal speed";
  parameter SI.Torque T_cog(min = 0, nominal = 0.01) = 0 "Amplitude of the cogging torque";
  parameter Integer h_c(min = 1) = 144 "Order of the cogging torque: least common multiple of poles and slots";
  parameter SI.Temperature T(min = 200, max = 500) = 293.15 "Temperature of windings and magnets, without heatPort";
  parameter Boolean useHeatPort = false "true: temperature and losses go through heatPort" annotation(Evaluate = true);
  Interfaces.HeatPort heatPort(T = T_w, Q_flow = -(P_cu + P_fe/w_nom^2*w^2)) if useHeatPort "Windings and magnets";
  parameter SI.Temperature T_ref(min = 200, max = 500) = 293.15 "Temperature of R_s and psi_f";
  parameter SI.LinearTemperatureCoefficient alpha_R(min = 0, max = 0.02) = 0.0039 "Temperature coefficient of the resistance";
  parameter SI.LinearTemperatureCoefficient alpha_psi(min = -0.01, max = 0) = -0.0012 "Temperature coefficient of the flux";
  SI.AngularVelocity w(nominal = 100) "Speed";
  SI.Torque T_e "Electromagnetic torque";
  SI.Power P_cu "Copper loss";
  SI.Temperature T_w(nominal = 300) "Temperature of windings and magnets";
  SI.Resistance R "Resistance of a phase";
  SI.MagneticFlux psi "Flux linkage of the magnets";
equation
  assert(p >= 1, "The number of pole pairs p must be at least 1");
  assert(psi_f > 0 and L_d > 0 and L_q > 0, "Flux linkage and inductances must be positive");
  if not useHeatPort then
    T_w = T;
  end if;
  R = R_s*(1 + alpha_R*(T_w - T_ref));
  psi = psi_f*(1 + alpha_psi*(T_w - T_ref));
  w = der(flange.phi);
  L_d*der(i_d) = u_d - R*i_d + p*w*L_q*i_q;
  L_q*der(i_q) = u_q - R*i_q - p*w*(L_d*i_d + psi);
  T_e = 1.5*p*(psi*i_q + (L_d - L_q)*i_d*i_q);
  P_cu = 1.5*R*(i_d^2 + i_q^2);
  flange.tau = -T_e + P_fe/w_nom^2*w + T_cog*sin(h_c*flange.phi);
  annotation(Documentation(info = "<html><p>Currents and voltages are peak values of a phase; <code>T_e = 3/2 p (psi_f i_q + (L_d - L_q) i_d i_q)</code>. Iron loss is a resistor across the EMF, in torque a viscous term.
Defaults: motor of Zhang et al., Processes 2021, 9, 814, table 1, with eight pole pairs and 0.08 Wb (0.8 Wb as printed would give 2 kV). Source: P. C. Krause, Analysis of Electric Machinery. Saturation and harmonics of the flux are left out.</p></html>"));
end PMSM;
