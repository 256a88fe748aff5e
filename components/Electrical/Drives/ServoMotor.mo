within Electrical.Drives;
model ServoMotor "Torque-controlled PMSM with field-oriented current control"
  Interfaces.RealInput T_ref(unit = "N.m") "Command of torque";
  Interfaces.RotationalFlange flange "Shaft";
  parameter SI.Torque T_max(min = 0) = 9.54 "Greatest torque";
  parameter SI.Voltage V_dc(min = 1) = 540 "Voltage of the DC link";
  Machines.PMSM motor "Motor";
  CurrentControl control(p = motor.p, R_s = motor.R_s, L = motor.L_q, psi_f = motor.psi_f, V_dc = V_dc) "Current control";
  SI.Torque T_e "Torque of the motor";
equation
  assert(T_max > 0, "T_max must be positive");
  T_e = motor.T_e;
  control.i_d_ref = 0;
  control.i_q_ref = min(max(T_ref, -T_max), T_max)/(1.5*motor.p*motor.psi_f);
  connect(control.i_d, motor.i_d);
  connect(control.i_q, motor.i_q);
  connect(control.u_d, motor.u_d);
  connect(control.u_q, motor.u_q);
  control.w = motor.w;
  connect(motor.flange, flange);
  annotation(Documentation(info = "<html><p><code>PMSM</code> with <code>CurrentControl</code>: torque follows its command within a millisecond until the voltage ends. For longer runs <code>TorqueSource</code> is the same as a lag.</p></html>"));
end ServoMotor;
