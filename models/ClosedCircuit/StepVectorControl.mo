within ClosedCircuit;
model StepVectorControl "Fig. 12: step of the load command under sensorless vector control"
  extends Case3(
    control = Control.SFVC);
  annotation(
    experiment(StartTime = 0, StopTime = 40, Interval = 0.005, Tolerance = 1e-7),
    Documentation(info = "<html><p>The commanded speed is the synchronous one of 27.74 Hz, 832 r/min. The speed of the hydraulic motor falls by 28 r/min, what leakage takes, instead of 81; but the pressure overshoots by 29 % and the speed needs 1.64 s to settle instead of 0.60 s. With the drive reduced to lags (<code>control = Control.SFVC_reduced</code>) it is 34 % and 1.66 s.</p></html>"));
end StepVectorControl;
