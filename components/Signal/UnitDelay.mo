within Signal;
block UnitDelay "Delay by one sampling period"
  extends Bases.Sampled(y(start = y_start, fixed = true));
  parameter Real y_start = 0 "Output before the first sample";
  discrete Real x(start = y_start, fixed = true) "Last input";
equation
  when tick then
    x = u;
    y = pre(x);
  end when;
  annotation(Documentation(info = "<html><p>The input of the last sample.</p></html>"));
end UnitDelay;
