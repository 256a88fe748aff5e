within Electrical.Examples;
model SampledSpeedControlExample "Speed loop of a servo drive under a load step"
  Signal.Ramp speed(height = 100, duration = 0.1);
  Drives.SampledSpeedControl control;
  Drives.TorqueSource motor;
  Drives.Encoder encoder;
  Mechanical.Rotational.Inertia rotor(J = 1.8e-4);
  Mechanical.Rotational.Torque load;
  Signal.Step torque(height = -1, startTime = 0.3);
equation
  connect(speed.y, control.w_ref);
  connect(encoder.w, control.w);
  connect(control.T, motor.T_ref);
  connect(motor.flange, rotor.flange_a);
  connect(rotor.flange_a, encoder.flange);
  connect(rotor.flange_b, load.flange);
  connect(torque.y, load.tau);
  annotation(experiment(StartTime = 0, StopTime = 0.6, Interval = 0.0012, Tolerance = 1e-6));
end SampledSpeedControlExample;
