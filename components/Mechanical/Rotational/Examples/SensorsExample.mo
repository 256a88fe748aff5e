within Mechanical.Rotational.Examples;
model SensorsExample "Sensors on one shaft"
  Signal.Sine sine(amplitude = 10, f = 1);
  Torque drive;
  Inertia mass(J = 1);
  TorqueSensor through;
  PowerSensor power;
  PositionSensor position;
  SpeedSensor speed;
  AccelerationSensor acceleration;
  Inertia load(J = 1);
equation
  connect(sine.y, drive.tau);
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, through.flange_a);
  connect(through.flange_b, power.flange_a);
  connect(power.flange_b, load.flange_a);
  connect(load.flange_b, position.flange);
  connect(load.flange_b, speed.flange);
  connect(load.flange_b, acceleration.flange);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end SensorsExample;
