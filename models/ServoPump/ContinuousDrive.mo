within ServoPump;
model ContinuousDrive "Continuous speed controller, exact speed, torque with a lag"
  extends Drive;
  parameter SI.Torque T_max(min = 0) = 9.54 "Greatest torque, three times the rated";
  Electrical.Drives.ContinuousSpeedControl control(T_max = T_max) "Speed controller";
  Electrical.Drives.TorqueSource motor(T_max = T_max) "Motor with current loop";
  Electrical.Drives.IdealEncoder encoder "Encoder";
equation
  connect(w_ref, control.w_ref);
  connect(encoder.w, control.w);
  connect(control.T, motor.T_ref);
  connect(motor.flange, flange);
  connect(encoder.flange, flange);
  T_e = motor.T_e;
  w_meas = encoder.w;
end ContinuousDrive;
