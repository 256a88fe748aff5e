within Signal;
block Clock "Time"
  extends Bases.Source(y(unit = "s"));
equation
  y = time;
  annotation(Documentation(info = "<html><p>The time since the start time.</p></html>"));
end Clock;
