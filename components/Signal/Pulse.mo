within Signal;
block Pulse "Periodic rectangle"
  extends Bases.Source;
  parameter Real amplitude = 1 "Height";
  parameter Real width(unit = "1", min = 0, max = 1) = 0.5 "Share of the period at the height";
  parameter SI.Time period(min = 1e-9) = 1 "Period";
  parameter Real offset = 0 "Low value";
  parameter SI.Time startTime = 0 "Begin of the first period";
protected
  SI.Time t_0(start = startTime, fixed = true) "Begin of the present period";
equation
  assert(period > 0, "The period must be positive");
  when sample(startTime, period) then
    t_0 = time;
  end when;
  y = offset + (if time < startTime or time >= t_0 + width*period then 0 else amplitude);
  annotation(Documentation(info = "<html><p><code>amplitude</code> during the share <code>width</code> of each period.</p></html>"));
end Pulse;
