within ClosedCircuit;
model Case3 "Case 3: step of the load command (also Figs. 10 and 11 by motor and J_L)"
  extends Reduced(
    highSide(redeclare model Air = Hydraulic.EntrainedAir.Dissolving(x_start = 1e-4)),
    redeclare Signal.Step command(height = 3, offset = u, startTime = 20));
  annotation(
    experiment(StartTime = 0, StopTime = 40, Interval = 0.005, Tolerance = 1e-7),
    Documentation(info = "<html><p>3 to 6 V at 27.74 Hz. A stiffer motor (B) loses less speed, 50 r/min instead of 81, and lets the pressure overshoot, by 7.6 %; a greater inertia only slows the answer.</p></html>"));
end Case3;
