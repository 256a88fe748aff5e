within Mechanical.Rotational.Examples;
model RelativePositionSensorExample "The twist of an elastic shaft, measured"
  Signal.Sine sine(amplitude = 10, f = 1);
  Torque drive;
  Inertia mass(J = 1);
  SpringDamper shaft(c = 500, d = 1);
  Inertia load(J = 1);
  RelativePositionSensor sensor;
equation
  connect(sine.y, drive.tau);
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, shaft.flange_a);
  connect(shaft.flange_b, load.flange_a);
  connect(sensor.flange_a, mass.flange_b);
  connect(sensor.flange_b, load.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end RelativePositionSensorExample;
