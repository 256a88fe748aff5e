within Electrical.Examples;
model FluxVectorDriveExample "Speed held under a step of the load, rotor resistance assumed too high"
  Signal.Constant speed(k = 80);
  Drives.FluxVectorDrive drive(R_hat = 1.3);
  Mechanical.Rotational.Inertia rotor(J = 1);
  Signal.Step load(height = -100, startTime = 3);
  Mechanical.Rotational.Torque torque;
equation
  connect(speed.y, drive.w_ref);
  connect(drive.flange, rotor.flange_a);
  connect(load.y, torque.tau);
  connect(torque.flange, rotor.flange_b);
  annotation(experiment(StartTime = 0, StopTime = 6, Interval = 0.01, Tolerance = 1e-6));
end FluxVectorDriveExample;
