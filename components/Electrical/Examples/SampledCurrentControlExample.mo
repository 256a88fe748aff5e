within Electrical.Examples;
model SampledCurrentControlExample "Torque steps of a servo motor whose current control is sampled"
  extends PMSMExample(motor(redeclare Drives.SampledCurrentControl control));
  annotation(experiment(StartTime = 0, StopTime = 0.5, Interval = 0.001, Tolerance = 1e-4));
end SampledCurrentControlExample;
