within Electrical.Examples;
model VfSlipInverterExample "An induction motor under load, its slip compensated"
  Signal.Ramp frequency(height = 30, duration = 2);
  Drives.VfSlipInverter inverter;
  Machines.InductionMotorSteady motor;
  Mechanical.Rotational.Inertia rotor(J = 1);
  Signal.Step load(height = -100, startTime = 4);
  Mechanical.Rotational.Torque torque;
equation
  connect(frequency.y, inverter.f_ref);
  connect(inverter.f, motor.f);
  connect(inverter.U, motor.U);
  inverter.T = motor.T_e;
  connect(motor.flange, rotor.flange_a);
  connect(load.y, torque.tau);
  connect(torque.flange, rotor.flange_b);
  annotation(experiment(StartTime = 0, StopTime = 6, Interval = 0.01, Tolerance = 1e-6));
end VfSlipInverterExample;
