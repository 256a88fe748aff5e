within Signal;
block SmoothMove "There and back without corners: smooth step up, hold, smooth step down"
  extends Bases.Source;
  parameter Real amplitude = 1 "Height";
  parameter SI.Time rising(min = 1e-9) = 1 "Time of the way there";
  parameter SI.Time holding(min = 0) = 1 "Time at the height";
  parameter SI.Time falling(min = 1e-9) = 1 "Time of the way back";
  parameter Real offset = 0 "Value outside";
  parameter SI.Time startTime = 0 "Begin";
equation
  assert(rising > 0 and falling > 0, "rising and falling must be positive");
  y = offset + amplitude*(if time < startTime then 0
    elseif time < startTime + rising then Smooth.step((time - startTime)/rising)
    elseif time < startTime + rising + holding then 1
    elseif time < startTime + rising + holding + falling then 1 - Smooth.step((time - startTime - rising - holding)/falling)
    else 0);
  annotation(Documentation(info = "<html><p>The greatest rate is 1.5 times the mean one. Begin and end of each way are events, so that no step of the integrator passes over a move.</p></html>"));
end SmoothMove;
