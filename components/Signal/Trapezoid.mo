within Signal;
block Trapezoid "One trapezoid: rise, hold, fall"
  extends Bases.Source;
  parameter Real amplitude = 1 "Height";
  parameter SI.Time rising(min = 1e-9) = 0.1 "Time of the rise";
  parameter SI.Time holding(min = 0) = 1 "Time at the height";
  parameter SI.Time falling(min = 1e-9) = 0.1 "Time of the fall";
  parameter Real offset = 0 "Value outside";
  parameter SI.Time startTime = 0 "Begin of the rise";
protected
  SI.Time t "Time since the start";
equation
  t = time - startTime;
  y = offset + (if time < startTime then 0
    elseif time < startTime + rising then amplitude*t/rising
    elseif time < startTime + rising + holding then amplitude
    elseif time < startTime + rising + holding + falling then amplitude*(rising + holding + falling - t)/falling
    else 0);
  annotation(Documentation(info = "<html><p>Up, hold and down along straight lines, once.</p></html>"));
end Trapezoid;
