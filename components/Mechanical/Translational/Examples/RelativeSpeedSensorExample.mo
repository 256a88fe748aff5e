within Mechanical.Translational.Examples;
model RelativeSpeedSensorExample "The stroke of a spring between two masses, measured"
  Signal.Sine sine(amplitude = 10, f = 1);
  Force drive;
  Mass mass(m = 1);
  SpringDamper rod(c = 500, d = 1);
  Mass load(m = 1);
  RelativeSpeedSensor sensor;
equation
  connect(sine.y, drive.f);
  connect(drive.flange, mass.flange_a);
  connect(mass.flange_b, rod.flange_a);
  connect(rod.flange_b, load.flange_a);
  connect(sensor.flange_a, mass.flange_b);
  connect(sensor.flange_b, load.flange_a);
  annotation(experiment(StartTime = 0, StopTime = 2, Interval = 0.004, Tolerance = 1e-6));
end RelativeSpeedSensorExample;
