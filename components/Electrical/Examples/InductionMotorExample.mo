within Electrical.Examples;
model InductionMotorExample "Start of a motor on an inverter"
  Signal.Ramp frequency(height = 27.74, duration = 2);
  Drives.VfInverter inverter;
  Machines.InductionMotor motor;
  Mechanical.Rotational.Inertia rotor(J = 0.4);
  Mechanical.Rotational.QuadraticLoad load(tau_nominal = 100, w_nominal = 87);
equation
  connect(frequency.y, inverter.f_ref);
  connect(inverter.f, motor.f);
  connect(inverter.U, motor.U);
  connect(motor.flange, rotor.flange_a);
  connect(rotor.flange_b, load.flange);
  annotation(experiment(StartTime = 0, StopTime = 4, Interval = 0.008, Tolerance = 1e-6));
end InductionMotorExample;
