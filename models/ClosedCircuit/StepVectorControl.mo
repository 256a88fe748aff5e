within ClosedCircuit;
model StepVectorControl "Fig. 12: step of the load command under sensorless vector control"
  extends Case3(
    control = Control.SFVC,
    f = 24.8127);
  annotation(
    experiment(StartTime = 0, StopTime = 30, Interval = 0.005, Tolerance = 1e-7),
    Documentation(info = "<html><p>The commanded speed is that of the pump under V/f, 744.4 r/min. The speed of the hydraulic motor falls by 28 r/min, what leakage takes; the pressure oscillates longer than under V/f.</p></html>"));
end StepVectorControl;
