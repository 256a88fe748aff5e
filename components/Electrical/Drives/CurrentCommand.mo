within Electrical.Drives;
partial model CurrentCommand "Currents of both axes for a commanded torque"
  Interfaces.RealInput T(unit = "N.m") "Command of torque";
  Interfaces.RealInput u_d(unit = "V") "Voltage of the d axis that the current control commands, peak";
  Interfaces.RealInput u_q(unit = "V") "Voltage of the q axis that the current control commands, peak";
  Interfaces.RealInput i_q(unit = "A") "Measured current of the q axis, peak";
  Interfaces.RealOutput i_d_ref(unit = "A") "Command of the d axis, peak";
  Interfaces.RealOutput i_q_ref(unit = "A") "Command of the q axis, peak";
  parameter Integer p(min = 1, max = 100) = 8 "Pole pairs";
  parameter SI.MagneticFlux psi_f(min = 1e-6, max = 100, nominal = 0.1) = 0.08 "Flux linkage of the magnets, peak";
  parameter SI.Inductance L_d(min = 1e-9, max = 10, nominal = 1e-3) = 0.314e-3 "Inductance of the d axis";
  parameter SI.Inductance L_q(min = 1e-9, max = 10, nominal = 1e-3) = 0.314e-3 "Inductance of the q axis";
  parameter SI.Voltage V_dc(min = 1, max = 1e5) = 540 "Voltage of the DC link known to the controller";
equation
  assert(psi_f > 0 and L_d > 0 and L_q > 0, "Flux linkage and inductances must be positive");
  annotation(Documentation(info = "<html><p>Forms with equal ports: <code>ZeroDirectCurrent</code>, <code>MaximumTorqueCurrent</code>.</p></html>"));
end CurrentCommand;
