within ClosedCircuit;
model StepHeavyLoad "Fig. 11: step of the load command with twice the inertia of the load"
  extends Case3(
    J_L = 4);
  annotation(
    experiment(StartTime = 0, StopTime = 40, Interval = 0.005, Tolerance = 1e-7),
    Documentation(info = "<html><p>Beside <code>Case3</code>, 2 kg m2: the speed falls by the same 81 r/min, but needs 1.31 s instead of 0.60 s. Inertia changes only how the circuit gets there.</p></html>"));
end StepHeavyLoad;
