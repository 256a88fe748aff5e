within ClosedCircuit;
model Case2 "Case 2: ramps of the load command up and down at constant frequency"
  extends Reduced(
    highSide(redeclare model Air = Hydraulic.EntrainedAir.Dissolving(x_start = 1e-4)),
    redeclare Signal.Trapezoid command(amplitude = 3, rising = 6, holding = 6, falling = 6, offset = u, startTime = 10));
  annotation(
    experiment(StartTime = 0, StopTime = 40, Interval = 0.01, Tolerance = 1e-7),
    Documentation(info = "<html><p>3 to 6 V and back in 6 s each at 27.74 Hz: the hydraulic motor slows from 694 to 613 r/min and recovers, the pressure rises from 10.32 to 16.54 MPa and falls back.</p></html>"));
end Case2;
