within ServoPump;
model SampledFieldOrientedDrive "Sampled speed controller and encoder with quantisation on the PMSM with current loops, averaged inverter and cogging"
  extends Drive;
  parameter SI.Torque T_max(min = 0) = 9.54 "Greatest torque, three times the rated";
  parameter SI.Time T_s(min = 1e-6) = 0.625e-3 "Sampling period";
  parameter Integer N_c(min = 1) = 10000 "Counts of the encoder per revolution";
  parameter SI.Torque T_cog(min = 0) = 0.02 "Cogging torque";
  Electrical.Drives.SampledSpeedControl control(T_max = T_max, T_s = T_s) "Speed controller";
  replaceable Electrical.Drives.ServoMotor motor constrainedby Electrical.Drives.ServoMotor(T_max = T_max, motor(T_cog = T_cog)) "Motor with current control";
  Electrical.Drives.Encoder encoder(N_c = N_c, T_s = T_s) "Encoder";
equation
  connect(w_ref, control.w_ref);
  connect(encoder.w, control.w);
  connect(control.T, motor.T_ref);
  connect(motor.flange, flange);
  connect(encoder.flange, flange);
  T_e = motor.T_e;
  w_meas = encoder.w;
end SampledFieldOrientedDrive;
