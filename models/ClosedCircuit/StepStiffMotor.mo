within ClosedCircuit;
model StepStiffMotor "Fig. 10: step of the load command with the stiff motor"
  extends Case3(
    motor = MotorType.B);
  annotation(
    experiment(StartTime = 0, StopTime = 40, Interval = 0.005, Tolerance = 1e-7),
    Documentation(info = "<html><p>Beside <code>Case3</code>, the soft motor: 50 r/min are lost instead of 81, and the pressure overshoots by 7.6 %. The stiffness of the drive changes both where the circuit settles and how it gets there.</p></html>"));
end StepStiffMotor;
