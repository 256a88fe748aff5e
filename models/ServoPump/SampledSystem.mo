within ServoPump;
model SampledSystem "The system of Fig. 1 with the sampled drive: 0.625 ms, encoder with quantisation, cogging"
  extends System(
    redeclare SampledDrive drive);
  annotation(
    experiment(StartTime = 0, StopTime = 3, Interval = 0.002, Tolerance = 1e-5),
    Documentation(info = "<html><p>Each sample changes the torque command, so that 4800 events break up the run. Finer steps than a tolerance of 1e-5 asks for resolve what the encoder, with 9.6 r/min a count, does not see.</p></html>"));
end SampledSystem;
