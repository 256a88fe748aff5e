within Electrical.Examples;
model FieldWeakeningExample "A motor under flux vector control goes beyond its nominal speed: the flux weakens at the limit of the voltage"
  Drives.FluxVectorDrive drive(voltageLimit = true);
  Signal.Ramp speed(height = 400, duration = 1.5);
  Mechanical.Rotational.Inertia load(J = 0.5);
equation
  connect(speed.y, drive.w_ref);
  connect(drive.flange, load.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 6, Interval = 0.01, Tolerance = 1e-6));
end FieldWeakeningExample;
