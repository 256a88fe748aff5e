within Electrical.Examples;
model CurrentSensorErrorsExample "Torque ripple of a motor whose current sensors have an offset"
  Machines.PMSM motor;
  Drives.CurrentSensorErrors sensors(offset_a = 0.05, gain_b = 1.02);
  Drives.ContinuousCurrentControl control;
  Mechanical.Rotational.ConstantSpeed shaft(w_fixed = 20);
equation
  control.i_d_ref = 0;
  control.i_q_ref = 2;
  control.w = motor.w;
  connect(motor.i_d, sensors.i_d);
  connect(motor.i_q, sensors.i_q);
  sensors.phi = motor.flange.phi;
  connect(sensors.j_d, control.i_d);
  connect(sensors.j_q, control.i_q);
  connect(control.u_d, motor.u_d);
  connect(control.u_q, motor.u_q);
  connect(shaft.flange, motor.flange);
  annotation(experiment(StartTime = 0, StopTime = 0.5, Interval = 0.0005, Tolerance = 1e-6));
end CurrentSensorErrorsExample;
