within Electrical.Drives;
model ServoMotor "Torque-controlled PMSM with field-oriented current control and inverter"
  Interfaces.RealInput T_ref(unit = "N.m") "Command of torque";
  Interfaces.RotationalFlange flange "Shaft";
  Interfaces.Pin dc_p if externalSupply "Positive pin of the DC link";
  Interfaces.Pin dc_n if externalSupply "Negative pin of the DC link";
  parameter SI.Torque T_max(min = 1e-6) = 9.54 "Greatest torque that is commanded";
  parameter SI.Voltage V_dc(min = 1) = 540 "Voltage of the DC link";
  parameter Boolean externalSupply = false "true: the DC link is joined to dc_p and dc_n, and V_dc is what the controller takes it for" annotation(Evaluate = true);
  Machines.PMSM motor "Motor";
  replaceable ContinuousCurrentControl control constrainedby CurrentControl(
    p = motor.p, R_s = motor.R_s, L = motor.L_q, L_d = motor.L_d, psi_f = motor.psi_f, V_dc = V_dc) "Current control";
  replaceable ZeroDirectCurrent command constrainedby CurrentCommand(
    p = motor.p, L_d = motor.L_d, L_q = motor.L_q, psi_f = motor.psi_f, V_dc = V_dc) "Currents for the torque";
  replaceable AveragedInverter inverter constrainedby Inverter(p = motor.p) "Inverter";
  ConstantVoltage supply(V = V_dc) if not externalSupply "DC link of constant voltage";
  Ground ground if not externalSupply "Its reference";
  SI.Torque T_e "Torque of the motor";
equation
  assert(T_max > 0, "T_max must be positive");
  T_e = motor.T_e;
  command.T = min(max(T_ref, -T_max), T_max);
  command.u_d = control.u_d;
  command.u_q = control.u_q;
  command.i_q = motor.i_q;
  control.i_d_ref = command.i_d_ref;
  control.i_q_ref = command.i_q_ref;
  connect(control.i_d, motor.i_d);
  connect(control.i_q, motor.i_q);
  control.w = motor.w;
  connect(control.u_d, inverter.u_d);
  connect(control.u_q, inverter.u_q);
  connect(motor.i_d, inverter.i_d);
  connect(motor.i_q, inverter.i_q);
  inverter.phi = motor.flange.phi;
  inverter.w = motor.w;
  connect(inverter.v_d, motor.u_d);
  connect(inverter.v_q, motor.u_q);
  connect(supply.p, inverter.dc_p);
  connect(supply.n, inverter.dc_n);
  connect(supply.n, ground.p);
  connect(dc_p, inverter.dc_p);
  connect(dc_n, inverter.dc_n);
  connect(motor.flange, flange);
  annotation(Documentation(info = "<html><p><code>PMSM</code>, current control and inverter: torque follows its command within a millisecond until the voltage ends. Control and inverter can be exchanged: <code>ContinuousCurrentControl</code> (default) or <code>SampledCurrentControl</code>, <code>AveragedInverter</code> (default) or <code>SwitchingInverter</code>. <code>command</code> chooses the currents: <code>ZeroDirectCurrent</code> (default) or <code>MaximumTorqueCurrent</code>, which uses the reluctance torque and goes beyond the base speed by weakening the field. Braking, the motor feeds the DC link; what that does to its voltage is up to what is joined to <code>dc_p</code> and <code>dc_n</code>.</p>
<p>For longer runs <code>TorqueSource</code> is the same as a lag.</p></html>"));
end ServoMotor;
