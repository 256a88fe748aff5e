within Electrical.Examples;
model SensorlessVectorDriveExample "A load step under vector control"
  Signal.Ramp speed(height = 80, duration = 1);
  Drives.SensorlessVectorDrive drive;
  Mechanical.Rotational.Inertia rotor(J = 0.4);
  Mechanical.Rotational.Torque load;
  Signal.Step torque(height = -100, startTime = 2);
equation
  connect(speed.y, drive.w_ref);
  connect(drive.flange, rotor.flange_a);
  connect(rotor.flange_b, load.flange);
  connect(torque.y, load.tau);
  annotation(experiment(StartTime = 0, StopTime = 4, Interval = 0.008, Tolerance = 1e-6));
end SensorlessVectorDriveExample;
