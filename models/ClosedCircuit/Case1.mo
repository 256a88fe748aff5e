within ClosedCircuit;
model Case1 "Case 1: ramp of the frequency at constant load command"
  extends Reduced(
    highSide(redeclare model Air = Hydraulic.EntrainedAir.Dissolving(x_start = 1e-4)),
    f = 9.333,
    redeclare Signal.Ramp frequency(height = 24, duration = 10, offset = f, startTime = 10));
  annotation(
    experiment(StartTime = 0, StopTime = 35, Interval = 0.01, Tolerance = 1e-7),
    Documentation(info = "<html><p>9.33 to 33.33 Hz (synchronous speeds of 280 to 1000 r/min, as the range of the paper is read; the pump turns with 214 to 905 r/min) in 10 s at 3 V: the hydraulic motor runs up from 181 to 849 r/min, the pressure from 7.44 to 11.19 MPa with a hump while the load is accelerated.</p></html>"));
end Case1;
