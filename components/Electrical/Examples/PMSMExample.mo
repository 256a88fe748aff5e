within Electrical.Examples;
model PMSMExample "Torque steps of a servo motor"
  Drives.ServoMotor motor;
  Mechanical.Rotational.Inertia rotor(J = 1.8e-4);
  Mechanical.Rotational.Damper friction(d = 1e-3);
  Mechanical.Rotational.Fixed housing;
  Signal.Pulse torque(amplitude = 3, period = 0.2, offset = -1.5);
equation
  connect(torque.y, motor.T_ref);
  connect(motor.flange, rotor.flange_a);
  connect(rotor.flange_b, friction.flange_a);
  connect(friction.flange_b, housing.flange);
  annotation(experiment(StartTime = 0, StopTime = 0.5, Interval = 0.001, Tolerance = 1e-6));
end PMSMExample;
