within Electrical.Examples;
model AveragedInverterExample "The same with the inverter averaged"
  extends PMSMExample(
    motor(redeclare Drives.SampledCurrentControl control, inverter(real = true)),
    torque(amplitude = 12, offset = -6, period = 0.02));
  annotation(experiment(StartTime = 0, StopTime = 0.02, Interval = 1e-5, Tolerance = 1e-4));
end AveragedInverterExample;
