within Electrical.Examples;
model SwitchingInverterExample "Torque steps of a servo motor, every edge of the inverter"
  extends PMSMExample(
    motor(redeclare Drives.SampledCurrentControl control, redeclare Drives.SwitchingInverter inverter(real = true)),
    torque(amplitude = 12, offset = -6, period = 0.02));
  annotation(experiment(StartTime = 0, StopTime = 0.02, Interval = 1e-5, Tolerance = 1e-4));
end SwitchingInverterExample;
