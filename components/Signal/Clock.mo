within Signal;
block Clock "Time"
  extends Bases.Source(y(unit = "s"));
equation
  y = time;
end Clock;
