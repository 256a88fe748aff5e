within Electrical.Examples;
model MaximumTorqueCurrentExample "Torque over speed of a motor with buried magnets: full torque to the base speed, then less and less, at nearly constant power"
  Drives.ServoMotor motor(
    T_max = 60, V_dc = 300,
    redeclare Drives.MaximumTorqueCurrent command(i_max = 100),
    motor(p = 4, psi_f = 0.06, L_d = 0.4e-3, L_q = 1.0e-3, R_s = 0.02));
  Mechanical.Rotational.Speed shaft;
  Signal.Ramp speed(height = 1200, duration = 2, startTime = 0.1);
  Signal.Constant torque(k = 60);
  SI.Power power "Power of the shaft";
equation
  connect(torque.y, motor.T_ref);
  connect(speed.y, shaft.w_ref);
  connect(motor.flange, shaft.flange);
  power = motor.T_e*motor.motor.w;
  annotation(experiment(StartTime = 0, StopTime = 2.2, Interval = 0.002, Tolerance = 1e-6));
end MaximumTorqueCurrentExample;
