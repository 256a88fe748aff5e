within ServoPump;
model FieldOrientedDrive "Continuous speed controller on the PMSM with current loops and voltage limit"
  extends Drive;
  parameter SI.Torque T_max(min = 0) = 9.54 "Greatest torque, three times the rated";
  Electrical.Drives.ContinuousSpeedControl control(T_max = T_max) "Speed controller";
  Electrical.Drives.ServoMotor motor(T_max = T_max) "Motor with current control";
  Electrical.Drives.IdealEncoder encoder "Encoder";
equation
  connect(w_ref, control.w_ref);
  connect(encoder.w, control.w);
  connect(control.T, motor.T_ref);
  connect(motor.flange, flange);
  connect(encoder.flange, flange);
  T_e = motor.T_e;
  w_meas = encoder.w;
end FieldOrientedDrive;
